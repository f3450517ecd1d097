/*
 * The speeds of the rows (diagnose/identify/row_speeds.h): a cycle has the mean speed of its two samples, however the speed changes, and
 * follows the recorded angle where the speed column is off.
 */
#include "diagnose/identify/rows.h"
#include "diagnose_bench.h"

#include <math.h>
#include <unity.h>

enum { MOST = 3000, COLUMNS = 8 };

static const char *const names[COLUMNS] = {"t_s",           "i_a_A", "i_b_A", "theta_e_rad",
                                           "omega_e_rad_s", "u_a_V", "u_b_V", "u_c_V"};
static const double T_s = 1e-4;
static double column[COLUMNS][MOST];

void setUp(void)
{
}

void tearDown(void)
{
}

/* From so many rad per second, by so many more each second. */
static double angle(double from, double more, size_t k)
{
    const double t_s = T_s * (double)k;
    return from * t_s + 0.5 * more * t_s * t_s;
}

/* How far, in rad at the most, a cycle's turn by its row is off the angle's, with a speed column that is off by so much. */
static double most_off(size_t rows, double from, double more, double wrong)
{
    const motor m = bench_motor();
    const double *value[COLUMNS];
    double most = 0.0;
    for (size_t k = 0; k < rows; k++) {
        const double theta = angle(from, more, k);
        column[0][k] = T_s * (double)k;
        column[3][k] = fmod(theta, 6.283185307179586);
        column[4][k] = from + more * T_s * (double)k + wrong;
        for (size_t x = 0; x < 3; x++) {
            column[x < 2 ? 1 + x : 7][k] = 5.0 * sin(theta - 2.0943951023931953 * (double)x);
            column[5 + x][k] = 40.0 * cos(theta - 2.0943951023931953 * (double)x);
        }
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        value[c] = column[c];
    }
    error e = {0};
    recording rec;
    diagnose_rows r;
    TEST_ASSERT_TRUE_MESSAGE(recording_make(&rec, "made", rows, COLUMNS, names, value, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&r, &rec, &m, &e), e.text);
    for (size_t k = 0; k + 1 < rows; k++) {
        const double turn = angle(from, more, k + 1) - angle(from, more, k);
        most = fmax(most, fabs(r.row[k].omega_rad_s * T_s - turn));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, cos(r.row[k].omega_rad_s * T_s), r.row[k].cos_turn);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, sin(r.row[k].omega_rad_s * T_s), r.row[k].sin_turn);
    }
    rows_free(&r);
    recording_free(&rec);
    return most;
}

/* By the speed at its start a cycle would turn by half a cycle's change less: 2.5e-5 rad, in 40 V of EMF 15 mV. */
static void a_cycle_turns_by_its_own_mean_speed(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, most_off(MOST, 500.0, 5000.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, most_off(MOST, 900.0, -5000.0, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, most_off(190, 500.0, 5000.0, 0.0)); /* too short for a correction */
}

/* An error of the column that the angle shows. In a short recording it stays. */
static void a_speed_that_is_off_follows_the_angle(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, most_off(MOST, 500.0, 0.0, 2.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, most_off(MOST, 500.0, 2000.0, -2.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 2.0 * T_s, most_off(190, 500.0, 0.0, 2.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_cycle_turns_by_its_own_mean_speed);
    RUN_TEST(a_speed_that_is_off_follows_the_angle);
    return UNITY_END();
}

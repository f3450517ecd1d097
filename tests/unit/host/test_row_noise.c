/*
 * What of the recorded voltages is likely noise (diagnose/identify/row_noise.h): shown where a controller leaves no voltage, nothing where
 * there is none, at low speed, or in a short recording.
 */
#include "base/two_sided.h"
#include "diagnose/identify/row_noise.h"
#include "diagnose_bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

enum { ROWS = 8000, COLUMNS = 8 };

static const char *const names[COLUMNS] = {"t_s",           "i_a_A", "i_b_A", "theta_e_rad",
                                           "omega_e_rad_s", "u_a_V", "u_b_V", "u_c_V"};
static double column[COLUMNS][ROWS];
static vec_ab noise[ROWS]; /* in the recorded voltage */
static uint64_t state;

void setUp(void)
{
    state = 20261128;
}

void tearDown(void)
{
}

/*
 * A drive at one speed, `turn` rad per row: 100 V, and what a controller adds, differences of white noise in the stationary frame, which
 * has nothing slow there. Recorded with white noise of so many volts along the voltage.
 */
static diagnose_rows look(const motor *m, size_t rows, double turn, double noise_V, recording *rec)
{
    static const double T_s = 1e-4;
    const double *value[COLUMNS];
    vec_ab before = {bench_normal(&state), bench_normal(&state)};
    for (size_t k = 0; k < rows; k++) {
        const double theta = turn * (double)k;
        const vec_ab now = {bench_normal(&state), bench_normal(&state)};
        const vec_rotor r = {cos(theta), sin(theta)};
        const vec_dq along = {0.6 * noise_V, 0.8 * noise_V};
        const double n = bench_normal(&state);
        noise[k] = vec_to_ab((vec_dq){n * along.d, n * along.q}, r);
        const vec_ab u = vec_to_ab((vec_dq){60.0, 80.0}, r);
        double phase[3];
        vec_to_phases((vec_ab){u.alpha + 0.3 * (now.alpha - before.alpha) + noise[k].alpha,
                               u.beta + 0.3 * (now.beta - before.beta) + noise[k].beta},
                      phase);
        before = now;
        column[0][k] = T_s * (double)k;
        column[1][k] = 5.0 * sin(theta);
        column[2][k] = 5.0 * sin(theta - 2.0943951023931953);
        column[3][k] = fmod(theta, 6.283185307179586);
        column[4][k] = turn / T_s;
        for (size_t x = 0; x < 3; x++) {
            column[5 + x][k] = phase[x];
        }
    }
    for (size_t c = 0; c < COLUMNS; c++) {
        value[c] = column[c];
    }
    error e = {0};
    diagnose_rows made;
    TEST_ASSERT_TRUE_MESSAGE(recording_make(rec, "made", rows, COLUMNS, names, value, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&made, rec, m, &e), e.text);
    return made;
}

/* Mean square of what is slow in the stationary frame, of the noise less `share` of its estimate. */
static double slow_left(const diagnose_rows *r, double share)
{
    double *x = calloc(2 * r->rows, sizeof *x);
    double sum = 0.0;
    TEST_ASSERT_NOT_NULL(x);
    for (int axis = 0; axis < 2; axis++) {
        for (size_t k = 0; k < r->rows; k++) {
            const vec_ab part = r->row[k].u_noise_V;
            x[k] = axis == 0 ? noise[k].alpha - share * part.alpha : noise[k].beta - share * part.beta;
        }
        two_sided_mean(x, x + r->rows, r->rows, 0.95);
        for (size_t k = 0; k < r->rows; k++) {
            sum += x[k] * x[k] / (double)r->rows;
        }
    }
    free(x);
    return sum;
}

/* Mean square of the estimate. */
static double estimate_of(const diagnose_rows *r)
{
    double sum = 0.0;
    for (size_t k = 0; k < r->rows; k++) {
        const vec_ab part = r->row[k].u_noise_V;
        sum += (part.alpha * part.alpha + part.beta * part.beta) / (double)r->rows;
    }
    return sum;
}

static void noise_shows_where_a_controller_leaves_no_voltage(void)
{
    const motor m = bench_motor();
    for (double turn = -0.9; turn < 1.0; turn += 0.3) {
        if (fabs(turn) < 0.2) {
            continue;
        }
        recording rec;
        diagnose_rows r = look(&m, ROWS, turn, 0.05, &rec);
        const double all = slow_left(&r, 0.0);
        double least = all;
        double best = 0.0;
        TEST_ASSERT_TRUE(r.noise_shows);
        for (double share = 0.5; share <= 3.0; share += 0.25) {
            const double left = slow_left(&r, share);
            best = left < least ? share : best;
            least = fmin(least, left);
        }
        printf("turn %.1f: %.2f of the slow noise is left, at a share of %.2f\n", turn, least / all, best);
        TEST_ASSERT_TRUE(least < 0.3 * all);
        TEST_ASSERT_TRUE(best >= 1.0 && best <= 2.5);
        rows_free(&r);
        recording_free(&rec);
    }
}

static void without_noise_nothing_shows(void)
{
    const motor m = bench_motor();
    recording rec;
    diagnose_rows r = look(&m, ROWS, 0.4, 0.05, &rec);
    const double with = estimate_of(&r);
    rows_free(&r);
    recording_free(&rec);
    r = look(&m, ROWS, 0.4, 0.0, &rec);
    printf("without noise %.3f of the estimate with it\n", estimate_of(&r) / with);
    TEST_ASSERT_TRUE(estimate_of(&r) < 0.1 * with);
    rows_free(&r);
    recording_free(&rec);
}

static void expect_noise(bool shows, size_t rows, double turn)
{
    const motor m = bench_motor();
    recording rec;
    diagnose_rows r = look(&m, rows, turn, 0.05, &rec);
    TEST_ASSERT_EQUAL_INT(shows, r.noise_shows);
    TEST_ASSERT_EQUAL_INT(shows, estimate_of(&r) > 0.0);
    rows_free(&r);
    recording_free(&rec);
}

static void a_slow_rotor_or_a_short_recording_shows_nothing(void)
{
    expect_noise(false, ROWS, 0.09);
    expect_noise(false, 255, 0.4);
    expect_noise(true, 256, 0.4);
}

static void a_mean_from_both_sides_weighs_by_distance(void)
{
    enum { COUNT = 40 };
    static const double weight[] = {0.0, 0.3, 0.9, 0.99};
    for (size_t w = 0; w < sizeof weight / sizeof *weight; w++) {
        double x[COUNT];
        double mean[COUNT];
        double work[COUNT];
        for (size_t k = 0; k < COUNT; k++) {
            mean[k] = x[k] = bench_normal(&state);
        }
        two_sided_mean(mean, work, COUNT, weight[w]);
        for (size_t k = 0; k < COUNT; k++) {
            double sum = 0.0;
            double weights = 0.0;
            for (size_t j = 0; j < COUNT; j++) {
                const double by = pow(weight[w], fabs((double)k - (double)j));
                sum += by * x[j];
                weights += by;
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, sum / weights, mean[k]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(noise_shows_where_a_controller_leaves_no_voltage);
    RUN_TEST(without_noise_nothing_shows);
    RUN_TEST(a_slow_rotor_or_a_short_recording_shows_nothing);
    RUN_TEST(a_mean_from_both_sides_weighs_by_distance);
    return UNITY_END();
}

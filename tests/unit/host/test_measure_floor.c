/* The noise floor (floor.h) of recordings whose noise is known, with structure that no hypothesis accounts for. */
#include "diagnose/identify/fit.h"
#include "diagnose/measure/floor.h"
#include "diagnose_bench.h"

#include <math.h>
#include <unity.h>

static const double NOISE_A = 0.017;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The sensors' noise of a recording, measured with the motor file's drive. */
static double told_noise(recording *r)
{
    const motor m = bench_motor();
    diagnose_rows rows = {0};
    fit_data data = {0};
    fit_state state;
    error e = {0};
    double noise_A = 0.0;
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, r, &m, &e), e.text);
    const coordinate_frame frame = coordinates_of(&m, &rows);
    TEST_ASSERT_TRUE_MESSAGE(fit_data_make(&data, &rows, &frame, 100000, &e), e.text);
    TEST_ASSERT_TRUE(fit_of_nominal(&data, &state));
    measure_floor(&rows, &state, &frame.nominal, &noise_A);
    fit_data_free(&data);
    rows_free(&rows);
    return noise_A;
}

static recording recorded(void)
{
    const bench b = {.m = bench_motor(), .noise_A = NOISE_A, .seed = 20261123};
    return bench_record(&b);
}

static void noise_alone_is_measured(void)
{
    recording r = recorded();
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * NOISE_A, NOISE_A, told_noise(&r));
    recording_free(&r);
}

/* An angle's error of the third order does little at low speed, and at high speed looks like noise from one cycle to the next: by
 * these rows alone the sensors would be 1.8 times as noisy (0.030 A, measured before the quietest operating point bounded it). */
static void structure_at_speed_is_no_noise(void)
{
    recording r = recorded();
    for (size_t k = 0; k < r.rows; k++) {
        r.theta_e_rad[k] += 0.08 * sin(3.0 * r.theta_e_rad[k]);
    }
    TEST_ASSERT_TRUE(told_noise(&r) < 1.5 * NOISE_A);
    recording_free(&r);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(noise_alone_is_measured);
    RUN_TEST(structure_at_speed_is_no_noise);
    return UNITY_END();
}

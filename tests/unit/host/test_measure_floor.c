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

typedef struct told {
    double floor_A, noise_A; /* the noise of one sensor */
} told;

/* Of a recording, with the motor file's drive, to which a compensation is added. */
static told tell(recording *r, double compensation_V, double knee_A)
{
    const motor m = bench_motor();
    diagnose_rows rows = {0};
    fit_data data = {0};
    fit_state state;
    error e = {0};
    told t = {0.0, 0.0};
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&rows, r, &m, &e), e.text);
    const coordinate_frame frame = coordinates_of(&m, &rows);
    TEST_ASSERT_TRUE_MESSAGE(fit_data_make(&data, &rows, &frame, 100000, &e), e.text);
    TEST_ASSERT_TRUE(fit_of_nominal(&data, &state));
    averaged_drive drive = frame.nominal;
    drive.compensation_V = compensation_V;
    drive.compensation_knee_A = knee_A;
    t.floor_A = measure_floor(&rows, &state, &drive, &t.noise_A);
    fit_data_free(&data);
    rows_free(&rows);
    return t;
}

static double told_noise(recording *r)
{
    return tell(r, 0.0, 1.0).noise_A;
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

/*
 * Of a compensation whose sign the noise turns. The fit does not see a knee within four deviations of the noise, so it may be none; a wider
 * one is seen, and of what a hard switch would err by its noise's share is left.
 */
static void a_knee_that_noise_hides_may_be_none(void)
{
    recording r = recorded();
    const double none_A = tell(&r, 0.0, 1.0).floor_A;
    const double hard_A = tell(&r, 10.0, 1e-6).floor_A;
    const double hidden_A = tell(&r, 10.0, 3.0 * NOISE_A).floor_A;
    const double wide_A = tell(&r, 10.0, 20.0 * NOISE_A).floor_A;
    const double of_hard = hard_A * hard_A - none_A * none_A;
    TEST_ASSERT_TRUE(hard_A > 1.02 * none_A);
    TEST_ASSERT_EQUAL_DOUBLE(hard_A, hidden_A);
    /* A phase of a vector has less noise than a sensor of three, and more than one of two: 2/3 or 4/3 of its power. */
    const double share = (wide_A * wide_A - none_A * none_A) / of_hard;
    TEST_ASSERT_TRUE(share > 0.9 * sqrt(2.0 / 3.0) / 20.0 && share < 1.1 * sqrt(4.0 / 3.0) / 20.0);
    recording_free(&r);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_knee_that_noise_hides_may_be_none);
    RUN_TEST(noise_alone_is_measured);
    RUN_TEST(structure_at_speed_is_no_noise);
    return UNITY_END();
}

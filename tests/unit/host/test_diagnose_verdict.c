/* A cause that lowers the one-cycle error to the noise and raises the open-loop error is not named. */
#include "diagnose/diagnose.h"
#include "diagnose_bench.h"

#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/*
 * An angle that is off and an inductance that is wrong: at one operating point what they do along d all but cancels, and the
 * motor file's open-loop simulation stays near the current. One cycle shows the inductance, and hardly
 * the angle. Asked to skip all that is equivalent to an angle, the diagnosis has only the inductance, which makes the open-loop
 * simulation worse.
 */
static recording one_slow_run(double theta_0_rad, double of_inductance)
{
    bench b = {.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
    b.m.L_d_H *= of_inductance;
    b.m.L_q_H *= of_inductance;
    b.m.ext.has[CAUSE_ANGLE_OFFSET] = theta_0_rad != 0.0;
    b.m.ext.theta_0_rad = theta_0_rad;
    recording r = bench_record(&b);
    r.rows = BENCH_ROWS;
    r.stretches = 1;
    return r;
}

static diagnosis without_angles(recording *r)
{
    static const cause_id turns[] = {CAUSE_ANGLE_OFFSET,  CAUSE_ANGLE_DELAY, CAUSE_ANGLE_HARMONIC,
                                     CAUSE_VOLTAGE_DELAY, CAUSE_SENSOR_LAG,  CAUSE_FREE_CURRENT,
                                     CAUSE_LATE_SHARE,    CAUSE_IRON_LOSS,   CAUSE_SATURATION_DQ,
                                     CAUSE_SATURATION,    CAUSE_SALIENCY};
    const motor file = bench_motor();
    diagnose_options options = {0};
    diagnosis d;
    error e = {0};
    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        options.skip |= hypotheses_of(turns[k]);
    }
    TEST_ASSERT_TRUE_MESSAGE(diagnose(&d, r, &file, &options, &e), e.text);
    return d;
}

static void a_free_run_that_got_worse_is_no_explanation(void)
{
    recording r = one_slow_run(-0.02, 0.9);
    diagnosis d = without_angles(&r);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_UNEXPLAINED, d.verdict);
    TEST_ASSERT_TRUE(d.free_extended_percent == d.free_nominal_percent);
    diagnosis_free(&d);
    recording_free(&r);
    /* The same recording without the angle's error is explained. */
    r = one_slow_run(0.0, 0.9);
    d = without_angles(&r);
    TEST_ASSERT_EQUAL_size_t(1, d.causes);
    TEST_ASSERT_EQUAL_STRING("inductance", d.cause[0].id);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict);
    TEST_ASSERT_TRUE(d.free_extended_percent < d.free_nominal_percent);
    diagnosis_free(&d);
    recording_free(&r);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_free_run_that_got_worse_is_no_explanation);
    return UNITY_END();
}

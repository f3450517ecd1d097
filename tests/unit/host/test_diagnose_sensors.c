/*
 * What errs in the current sensors, on the bench of diagnose_bench.h: gains and offsets, with two sensors and with three,
 * and a filter.
 */
#include "diagnose_look.h"

#include <math.h>
#include <string.h>
#include <unity.h>

static bench good;

void setUp(void)
{
    good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
}

void tearDown(void)
{
}

static void an_offset_is_named_although_one_cycle_hardly_shows_it(void)
{
    good.m.ext.has[CAUSE_CURRENT_OFFSET] = true;
    good.m.ext.o_A[0] = 0.1;
    good.m.ext.o_A[1] = -0.06;
    good.m.ext.o_A[2] = -0.04;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "current_offset");
    holds(&d.cause[0], "o_a", 0.1);
    holds(&d.cause[0], "o_b", -0.06);
    TEST_ASSERT_TRUE(d.cause[0].gain < 1.2);
    diagnosis_free(&d);
}

/* A gain common to all sensors would be R and L through another scale: next to them only the mismatch is
 * reported. */
static void mismatched_sensors_with_resistance_and_inductance(void)
{
    static const double g[3] = {0.97, 0.99, 1.04};
    good.m.R_ohm = 0.6;
    good.m.L_d_H *= 0.88;
    good.m.L_q_H *= 0.88;
    good.m.ext.has[CAUSE_CURRENT_GAIN] = true;
    memcpy(good.m.ext.g, g, sizeof g);
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(3, d.causes);
    for (size_t k = 0; k < d.causes; k++) {
        if (strcmp(d.cause[k].id, "current_gain") == 0) {
            holds(&d.cause[k], "g_a", g[0]);
            holds(&d.cause[k], "g_b", g[1]);
            holds(&d.cause[k], "g_c", g[2]);
        } else if (strcmp(d.cause[k].id, "resistance") == 0) {
            holds(&d.cause[k], "R", 0.6);
        } else {
            TEST_ASSERT_EQUAL_STRING("inductance", d.cause[k].id);
            holds(&d.cause[k], "L", 0.5 * (good.m.L_d_H + good.m.L_q_H));
        }
    }
    diagnosis_free(&d);
}

static void two_sensors_with_one_gain_are_no_mismatch(void)
{
    good.two_sensors = true;
    good.m.ext.has[CAUSE_CURRENT_GAIN] = true;
    good.m.ext.g[0] = good.m.ext.g[1] = good.m.ext.g[2] = 1.05;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_TRUE(d.causes > 0);
    for (size_t k = 0; k < d.causes; k++) {
        TEST_ASSERT_NOT_EQUAL(0, strcmp("current_gain", d.cause[k].id));
    }
    diagnosis_free(&d);
}

/* A third column that a logger made of the two others is no third sensor. */
static void a_third_current_that_was_computed_tells_nothing(void)
{
    good.two_sensors = true;
    good.m.R_ohm = 1.1;
    double extended[2];
    for (int claimed = 0; claimed < 2; claimed++) {
        motor file = bench_motor();
        recording r = bench_record(&good);
        diagnosis d;
        error e = {0};
        const diagnose_options options = {0};
        r.i_c_measured = claimed == 1;
        TEST_ASSERT_FALSE(recording_three_sensors(&r));
        TEST_ASSERT_TRUE_MESSAGE(diagnose(&d, &r, &file, &options, &e), e.text);
        one_cause(&d, "resistance");
        extended[claimed] = d.extended;
        diagnosis_free(&d);
        recording_free(&r);
    }
    TEST_ASSERT_EQUAL_DOUBLE(extended[0], extended[1]);
    good.two_sensors = false;
    recording r = bench_record(&good);
    TEST_ASSERT_TRUE(recording_three_sensors(&r));
    recording_free(&r);
}

/*
 * It still sees the last edges, and so is no angle delay. An angle delay with an iron loss, whose current follows the edges, would fit as well.
 */
static void a_filter_of_the_currents_is_named(void)
{
    good.filter_s = 20e-6;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "sensor_lag");
    holds(&d.cause[0], "tau", 20e-6);
    diagnosis_free(&d);
    d = look_without(&good, hypotheses_of_cause("sensor_lag") | hypotheses_of_cause("iron_loss"));
    TEST_ASSERT_TRUE(d.verdict == VERDICT_PARTLY || d.verdict == VERDICT_UNEXPLAINED);
    diagnosis_free(&d);
    /* One that has forgotten the edges cannot be distinguished from it, and that is reported. */
    good.filter_s = 0.0;
    good.m.ext.has[CAUSE_ANGLE_DELAY] = true;
    good.m.ext.t_delay_s = 8e-6;
    d = look(&good, NULL);
    one_cause(&d, "angle_delay");
    TEST_ASSERT_EQUAL_size_t(1, d.cause[0].confused);
    TEST_ASSERT_EQUAL_STRING("sensor_lag", d.cause[0].confused_with[0]);
    diagnosis_free(&d);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_offset_is_named_although_one_cycle_hardly_shows_it);
    RUN_TEST(mismatched_sensors_with_resistance_and_inductance);
    RUN_TEST(two_sensors_with_one_gain_are_no_mismatch);
    RUN_TEST(a_third_current_that_was_computed_tells_nothing);
    RUN_TEST(a_filter_of_the_currents_is_named);
    return UNITY_END();
}

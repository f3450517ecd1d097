/*
 * The cycle: order of calls, time, status, safe output. In closed loop: test_cycle_loop.c.
 */
#include "cycle_fixture.h"
#include "iqfoc/transform.h"

#include <stdbool.h>
#include <string.h>

static void run_healthy(int32_t cycles)
{
    for (int32_t n = 0; n < cycles; n++) {
        valley();
        (void)peak();
    }
}

static void expect_safe(iqfoc_command_t command)
{
    TEST_ASSERT_FALSE(command.gates);
    TEST_ASSERT_EQUAL_INT32(0, command.duties.high.a | command.duties.high.b | command.duties.high.c);
    TEST_ASSERT_EQUAL_INT64(0, cycle.control.integral_d | cycle.control.integral_q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.u_ab.alpha | cycle.u_ab.beta);
}

/* A change to the configuration that init must refuse with this error, the object untouched. */
static void refused(iqfoc_error_t want, const iqfoc_cycle_config_t *bad)
{
    iqfoc_cycle_t object;
    iqfoc_cycle_t before;
    memset(&object, 0x5A, sizeof object);
    before = object;
    TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_init(&object, bad));
    TEST_ASSERT_EQUAL_MEMORY(&before, &object, sizeof object);
}

#define REFUSED(want, field, value)                                                                          \
    do {                                                                                                     \
        iqfoc_cycle_config_t bad = base_config;                                                              \
        bad.field = value;                                                                                   \
        refused(want, &bad);                                                                                 \
    } while (0)

static void test_init_refuses_by_name(void)
{
    refused(IQFOC_ERROR_NULL, NULL);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_init(NULL, &base_config));
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_u, 0);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_u, IQ24(16.0) + 1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_r, -1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_r, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_psi, -1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_psi, IQ24(8.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.kp_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.kp_q, IQ24(32.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.ki_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.ki_q, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.anti_windup, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.x_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.x_q, IQ24(96.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.emf, IQ24(96.0) + 1);
    REFUSED(IQFOC_ERROR_SPAN, span_max, 0);
    REFUSED(IQFOC_ERROR_SPAN, span_max, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_CURRENT_LIMIT, current_limit, 0);
    REFUSED(IQFOC_ERROR_CURRENT_LIMIT, current_limit, IQ24(16.0) + 1);
    REFUSED(IQFOC_ERROR_CHOICE, feedback, (iqfoc_feedback_t)7);
    REFUSED(IQFOC_ERROR_CHOICE, modulation, (iqfoc_modulation_t)7);
    REFUSED(IQFOC_ERROR_CHOICE, safe_state, (iqfoc_safe_state_t)7);
    REFUSED(IQFOC_ERROR_TIMES, period_ticks, UINT32_C(0x80000000));
    REFUSED(IQFOC_ERROR_TIMES, period_ticks, 0);
    REFUSED(IQFOC_ERROR_TIMES, time_unchecked, true); /* next to a period: one of the two is a mistake */
    REFUSED(IQFOC_ERROR_TIMES, tolerance_ticks, INT32_MAX - PERIOD + 1);
    REFUSED(IQFOC_ERROR_TIMES, tolerance_ticks, UINT32_MAX); /* the sum would wrap */
}

/* The longest sum that is taken still tells a long cycle from a good one. */
static void test_longest_times(void)
{
    config.tolerance_ticks = INT32_MAX - PERIOD;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    cycle.enabled = true;
    run_healthy(3);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    ticks += INT32_MAX - PERIOD;
    valley();
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    (void)peak();
    ticks += INT32_MAX - PERIOD + 1;
    valley();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
}

static void test_starts_disabled_and_safe(void)
{
    valley();
    expect_safe(peak());
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    cycle.enabled = true;
    valley();
    TEST_ASSERT_TRUE(peak().gates);
}

static void test_short_circuit_is_the_other_safe_state(void)
{
    config.safe_state = IQFOC_SAFE_SHORT_CIRCUIT;
    valley();
    const iqfoc_command_t command = peak();
    TEST_ASSERT_TRUE(command.gates);
    TEST_ASSERT_EQUAL_INT32(0, command.duties.high.a | command.duties.high.b | command.duties.high.c);
}

static void test_missed_peak_trips_until_cleared(void)
{
    cycle.enabled = true;
    run_healthy(5);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    valley();
    ticks += PERIOD / 2;
    valley();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    expect_safe(peak());
    run_healthy(3);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    valley();
    expect_safe(peak());
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    valley();
    TEST_ASSERT_TRUE(peak().gates);
}

static void test_missed_valley_and_missed_cycle(void)
{
    cycle.enabled = true;
    run_healthy(5);
    (void)peak();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    iqfoc_cycle_clear(&cycle);
    ticks += PERIOD / 2;
    run_healthy(3);
    ticks += PERIOD; /* a valley and its peak were lost together: only time tells */
    valley();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    TEST_ASSERT_EQUAL_INT32(0, cycle.error.alpha | cycle.error.beta);
}

static void test_no_time_checks_without_a_period(void)
{
    config.period_ticks = 0;
    config.time_unchecked = true;
    cycle.enabled = true;
    run_healthy(2);
    ticks += 7 * PERIOD;
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + 3 * PERIOD);
    TEST_ASSERT_TRUE(iqfoc_cycle_in_time(&cycle, &s, ticks + 3 * PERIOD));
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

static void test_stale_sample_by_its_age(void)
{
    cycle.enabled = true;
    run_healthy(3);
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + config.stale_ticks);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    ticks += PERIOD / 2;
    const iqfoc_sample_t old = sample_at(IQ24(0.5));
    expect_safe(iqfoc_cycle_peak(&cycle, &old, IQ24(1.5), ticks + config.stale_ticks + 1));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_STALE, cycle.status);
}

static void test_late_command(void)
{
    cycle.enabled = true;
    run_healthy(3);
    valley();
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
    TEST_ASSERT_TRUE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks));
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks + 1));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LATE, cycle.status);
    TEST_ASSERT_TRUE(cycle.tripped);
    expect_safe(iqfoc_cycle_safe(&config));
    /* Where it does not trip, the bit is all. */
    config.trips = 0;
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + PERIOD));
    TEST_ASSERT_FALSE(cycle.tripped);
}

static void test_what_is_measured_beyond_its_range(void)
{
    config.trips = 0; /* and not enabled: a clear then forgets the samples, too */
    iqfoc_sample_t s = sample_at(0);
    s.clipped = true;
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_SAMPLE_CLIPPED, cycle.status);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.i.a = IQ24(2.1);
    s.i.b = IQ24(-1.05);
    s.i.c = IQ24(-1.05);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERCURRENT, cycle.status);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.speed = IQ24(-0.4);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERSPEED, cycle.status);
    TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_SPEED_MAX, cycle.rotor.speed);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.u_dc = IQ24(0.3);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_DC_LINK, cycle.status);
}

static void test_voltage_limit_shows(void)
{
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(8.0);
    valley();
    const iqfoc_command_t command = peak();
    TEST_ASSERT_TRUE(command.duties.scale < IQ24_ONE);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_VOLTAGE_LIMIT, cycle.status);
    /* As a trip, it stops the drive at once. */
    config.trips = IQFOC_STATUS_VOLTAGE_LIMIT;
    iqfoc_cycle_clear(&cycle);
    valley();
    expect_safe(peak());
}

static void test_output_acts_at_the_angle_of_its_middle(void)
{
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(0.2);
    valley();
    iqfoc_sample_t s = sample_at(IQ24(0.5));
    s.speed = IQ24(0.08);
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
    const iqfoc_dq_t back = iqfoc_park(cycle.u_ab, iq24_sincos(s.theta + s.speed));
    TEST_ASSERT_INT32_WITHIN(2, cycle.u_dq.d, back.d);
    TEST_ASSERT_INT32_WITHIN(2, cycle.u_dq.q, back.q);
    /* A sample taken a tenth of a cycle later, an output two cycles long. */
    valley();
    s.instant = IQ24(0.6);
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(2.0), ticks);
    const iqfoc_dq_t late = iqfoc_park(cycle.u_ab, iq24_sincos(s.theta + to_iq24(0.08 * 1.4)));
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.d, late.d);
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.q, late.q);
}

/* Another angle: the voltage's place and the current's stay, and what is learnt of the old one goes. */
static void test_hand_over(void)
{
    iqfoc_sample_t s = sample_at(0);
    cycle.enabled = true;
    cycle.i_ref.d = IQ24(0.4);
    cycle.drift.d = cycle.drift.q = IQ24_ONE;
    valley();
    (void)peak();
    s.i.a = IQ24(0.3);
    s.i.b = IQ24(-0.2);
    s.i.c = IQ24(-0.1);
    s.theta = IQ24(0.37);
    const iqfoc_ab_t before = iqfoc_park_inverse(cycle.u_dq, iq24_sincos(IQ24(0.11)));
    iqfoc_cycle_hand_over(&cycle, IQ24(0.11), &s);
    const iqfoc_ab_t after = iqfoc_park_inverse(cycle.u_dq, iq24_sincos(s.theta));
    TEST_ASSERT_INT32_WITHIN(3, before.alpha, after.alpha);
    TEST_ASSERT_INT32_WITHIN(3, before.beta, after.beta);
    const iqfoc_ab_t i = iqfoc_park_inverse(cycle.i_ref, iq24_sincos(s.theta));
    TEST_ASSERT_INT32_WITHIN(2, iqfoc_clarke3(s.i).alpha, i.alpha);
    TEST_ASSERT_INT32_WITHIN(2, iqfoc_clarke3(s.i).beta, i.beta);
    const iqfoc_dq_t next =
        iqfoc_current_control_voltage(&cycle.control, &config.gains, cycle.i_ref, cycle.i_ref, s.speed);
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.d, next.d);
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.q, next.q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.drift.d);
    TEST_ASSERT_EQUAL_INT32(0, cycle.drift.q);
}

static void test_dc_link_inverse_follows(void)
{
    const double steps[] = {1.0, 1.1, 0.5, 1.5, 0.5, 0.9};
    for (int32_t k = 0; k < 6; k++) {
        for (int32_t n = 0; n < 8; n++) {
            valley();
            iqfoc_sample_t s = sample_at(IQ24(0.5));
            s.u_dc = to_iq24(steps[k]);
            (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
            if (k == 1 && n == 0) { /* the header's 1 % after a step of 10 % */
                TEST_ASSERT_DOUBLE_WITHIN(0.0101, 1.0, to_double(cycle.u_dc_inverse) * steps[k]);
            }
            if (k == 1 && n == 1) {
                TEST_ASSERT_DOUBLE_WITHIN(1.01e-4, 1.0, to_double(cycle.u_dc_inverse) * steps[k]);
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(2.5e-7, 1.0 / steps[k], to_double(cycle.u_dc_inverse));
    }
}

static void test_averaging_port_replaces_the_valley_sample(void)
{
    config.feedback = IQFOC_FEEDBACK_CORRECTED_MEAN;
    cycle.enabled = true;
    run_healthy(2);
    iqfoc_sample_t s = sample_at(0);
    s.has_mean = true;
    s.i_mean.a = IQ24(0.6);
    s.i_mean.b = IQ24(-0.3);
    s.i_mean.c = IQ24(-0.3);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    ticks += PERIOD / 2;
    (void)peak();
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(s.speed);
    /* The current is zero at both ends: only s1 of the mean is left, seen from the middle of the cycle that
     * ended; every sample here has the same angle, so that the middle is half a cycle's turn on. */
    const double angle = TWO_PI * (to_double(s.theta) + 0.5 * to_double(s.speed));
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(0.6 * to_double(rotor.s1) * cos(angle)), cycle.i_dq.d);
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(-0.6 * to_double(rotor.s1) * sin(angle)), cycle.i_dq.q);
}

static void test_six_step_takes_the_nearest_state(void)
{
    config.modulation = IQFOC_MODULATION_SIX_STEP;
    config.current_limit = IQ24(4.0);
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(0.3);
    for (int32_t n = 0; n < 40; n++) {
        valley();
        iqfoc_sample_t s = sample_at(IQ24(0.5));
        s.theta = n * (IQ24_ONE / 40);
        const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
        ticks += PERIOD / 2;
        const double turned = TWO_PI * (to_double(s.theta) + to_double(s.speed));
        const double angle = atan2(to_double(cycle.u_dq.q), to_double(cycle.u_dq.d)) + turned;
        const double off =
            remainder(angle - atan2(to_double(cycle.u_ab.beta), to_double(cycle.u_ab.alpha)), TWO_PI);
        TEST_ASSERT_TRUE(fabs(off) <= TWO_PI / 12.0 + 1e-6);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 / 3.0,
                                  hypot(to_double(cycle.u_ab.alpha), to_double(cycle.u_ab.beta)));
        const iqfoc_ab_t legs = iqfoc_clarke3(command.duties.high);
        TEST_ASSERT_INT32_WITHIN(2, cycle.u_ab.alpha, legs.alpha);
        TEST_ASSERT_INT32_WITHIN(2, cycle.u_ab.beta, legs.beta);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_refuses_by_name);
    RUN_TEST(test_longest_times);
    RUN_TEST(test_starts_disabled_and_safe);
    RUN_TEST(test_short_circuit_is_the_other_safe_state);
    RUN_TEST(test_missed_peak_trips_until_cleared);
    RUN_TEST(test_missed_valley_and_missed_cycle);
    RUN_TEST(test_no_time_checks_without_a_period);
    RUN_TEST(test_stale_sample_by_its_age);
    RUN_TEST(test_late_command);
    RUN_TEST(test_what_is_measured_beyond_its_range);
    RUN_TEST(test_voltage_limit_shows);
    RUN_TEST(test_output_acts_at_the_angle_of_its_middle);
    RUN_TEST(test_hand_over);
    RUN_TEST(test_dc_link_inverse_follows);
    RUN_TEST(test_averaging_port_replaces_the_valley_sample);
    RUN_TEST(test_six_step_takes_the_nearest_state);
    return UNITY_END();
}

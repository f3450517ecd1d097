/*
 * The cycle under faults and at its limits: the status bits of each fault, to the last value that is none, and the
 * state after clearing, stopping and a change of period.
 */
/* Ahead of the fixture, whose names theirs would hide. */
#include "iqfoc/cycle_steps.h"

#include "bits.h"
#include "cycle_fixture.h"
#include "iqfoc/observer.h"
#include "iqfoc/params.h"
#include "iqfoc/pattern_control.h"
#include "iqfoc/tracker.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Nine faults have a bit each, and the inverse of the link follows by half at the least. */
static void test_bits_and_the_least_factor(void)
{
    const uint32_t all[] = {IQFOC_STATUS_MISSED,         IQFOC_STATUS_LATE,        IQFOC_STATUS_STALE,
                            IQFOC_STATUS_SAMPLE_CLIPPED, IQFOC_STATUS_OVERCURRENT, IQFOC_STATUS_OVERSPEED,
                            IQFOC_STATUS_VOLTAGE_LIMIT,  IQFOC_STATUS_DC_LINK,     IQFOC_STATUS_NO_INTERVAL};
    for (uint32_t n = 0; n < sizeof all / sizeof *all; n++) {
        TEST_ASSERT_EQUAL_HEX32(UINT32_C(1) << n, all[n]);
    }
    TEST_ASSERT_INT32_WITHIN(1, IQ24(0.95), iqfoc_cycle_inverse_followed(IQ24(1.9), IQ24(1.0)));
}

/* A state in which every member that may be reset holds something. */
static void fill(void)
{
    cycle.status = 0x55;
    cycle.tripped = true;
    cycle.phase = IQFOC_CYCLE_DUE_PEAK;
    cycle.corrected = true;
    cycle.enabled = true;
    cycle.control.integral_d = 7;
    cycle.control.integral_q = 8;
    cycle.u_ab.alpha = 1;
    cycle.u_ab.beta = 2;
    cycle.u_dq.d = 3;
    cycle.u_dq.q = 4;
    cycle.drift.d = 5;
    cycle.drift.q = 6;
    cycle.duties_next.a = 9;
    cycle.duties_next.b = 10;
    cycle.duties_next.c = 11;
    cycle.i_next.alpha = 12;
    cycle.i_next.beta = 13;
}

static void test_a_fresh_cycle(void)
{
    memset(&cycle, 0x5A, sizeof cycle);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    TEST_ASSERT_TRUE(cycle.config == &config && cycle.next == &config && cycle.offered == &config);
    TEST_ASSERT_TRUE(iqfoc_cycle_taken(&cycle));
    TEST_ASSERT_EQUAL_UINT32(PERIOD, iqfoc_cycle_next_ticks(&cycle));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_CYCLE_DUE_NOTHING, cycle.phase);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, cycle.rotor.s1);
    TEST_ASSERT_EQUAL_INT32(0, cycle.rotor.s2 | cycle.rotor.speed);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, cycle.u_dc_inverse);
    TEST_ASSERT_FALSE(cycle.enabled || cycle.tripped || cycle.corrected);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

/* "Clears the status bits, the integrators and the memory of earlier samples." */
static void test_clear(void)
{
    fill();
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    TEST_ASSERT_FALSE(cycle.tripped);
    TEST_ASSERT_FALSE(cycle.corrected);
    TEST_ASSERT_TRUE(cycle.enabled);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_CYCLE_DUE_NOTHING, cycle.phase);
    TEST_ASSERT_EQUAL_INT64(0, cycle.control.integral_d);
    TEST_ASSERT_EQUAL_INT64(0, cycle.control.integral_q);
}

/* After clearing, no interval is whole until a valley has begun one: the peak says so. */
static void test_no_interval_after_clearing(void)
{
    config.feedback = IQFOC_FEEDBACK_CORRECTED_MEAN;
    cycle.enabled = true;
    for (int k = 0; k < 3; k++) {
        valley();
        (void)peak();
    }
    iqfoc_cycle_clear(&cycle);
    (void)peak();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_NO_INTERVAL | IQFOC_STATUS_MISSED, cycle.status);
}

/* The guard looks where a limit is passed, below that of the current one LSB later, and not before. */
static void test_the_guards_limits(void)
{
    iqfoc_sample_t s = sample_at(0);
    const iqfoc_ab_t none = {0, 0};
    for (int off = -1; off <= 1; off++) {
        s.u_dc = IQ24(1.5) + off;
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, none, ticks) > INT32_MAX);
        s.u_dc = IQ24(0.5) - off;
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, none, ticks) > INT32_MAX);
        s = sample_at(0);
        s.speed = IQFOC_GUARD_SPEED + off;
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, none, ticks) > INT32_MAX);
        s = sample_at(0);
        const iqfoc_ab_t along = {config.current_limit + off, 0};
        const iqfoc_ab_t across = {0, -config.current_limit - 1 - off};
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, along, ticks) > INT32_MAX);
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, across, ticks) > INT32_MAX);
        const uint32_t now = ticks + config.stale_ticks + (uint32_t)off;
        TEST_ASSERT_EQUAL(off > 0, iqfoc_guard_sample(&config, &s, none, now) > INT32_MAX);
    }
}

/* |x| <= limit in both components, which is what src/cycle.c asks. */
static bool in_limit(iqfoc_ab_t i, int32_t limit)
{
    return abs(i.alpha) <= limit && abs(i.beta) <= limit;
}

/* By its phases the guard lets no current through that is beyond a limit, and all that are 3 % below it. */
static void expect_phases(iq24_t limit, int32_t b, int32_t c)
{
    iqfoc_cycle_config_t set = config;
    set.current_limit = limit;
    const iqfoc_abc_t phases = {-(b + c) / 2, b, c};
    const iqfoc_ab_t i = iqfoc_clarke3(phases);
    const bool through = iqfoc_guard_phases(&set, phases) == 0;
    TEST_ASSERT_TRUE(!through || in_limit(i, limit));
    TEST_ASSERT_TRUE(through || !in_limit(i, limit - limit / 32 - 2));
}

static void test_the_guard_by_phases(void)
{
    for (int32_t k = 0; k < 200000; k++) {
        const iq24_t limit = k < 100000 ? k + 1 : IQ24(16.0) - (k - 100000) * 2684;
        const int32_t across = (int32_t)((int64_t)limit * 27 / 32);
        const int32_t along = limit;
        for (int32_t off = -3; off <= 3; off++) {
            expect_phases(limit, across + off, -across);
            expect_phases(limit, -across - off, across);
            expect_phases(limit, along + off, along + off);
            expect_phases(limit, -along - off, -along - off);
        }
    }
}

/* Where the modulator shortens the voltage, u_ab is what its duties make. */
static void test_voltage_is_what_the_duties_make(void)
{
    cycle.enabled = true;
    for (int n = 0; n < 3; n++) {
        cycle.i_ref.q = n == 0 ? IQ24(0.1) : IQ24(8.0);
        valley();
        const iqfoc_command_t command = peak();
        const iqfoc_ab_t made = iqfoc_clarke3(command.duties.high);
        TEST_ASSERT_EQUAL(n > 0, command.duties.scale < IQ24_ONE);
        TEST_ASSERT_INT32_WITHIN(32, made.alpha, cycle.u_ab.alpha);
        TEST_ASSERT_INT32_WITHIN(32, made.beta, cycle.u_ab.beta);
    }
}

/* "Their sum is held to 8": in overmodulation, the integrators at 7.5 and the decoupling held to 8. */
static void test_asked_is_held_to_eight(void)
{
    const iqfoc_methods_t over = {.modulation = IQFOC_MODULATION_OVER};
    config.gains.x_d = config.gains.x_q = IQ24(96.0);
    config.gains.emf = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        cycle.control.integral_d = cycle.control.integral_q = sign * (INT64_C(15) << 47); /* 7.5 */
        cycle.i_ref.d = sign * IQ24(2.0);
        cycle.i_ref.q = -sign * IQ24(2.0);
        cycle.i_dq = cycle.i_ref;
        const iqfoc_dq_t asked = iqfoc_cycle_pi_voltage(over, &cycle, &config, IQ24(0.25));
        TEST_ASSERT_EQUAL_INT32(sign * IQ24(8.0), asked.d);
        TEST_ASSERT_EQUAL_INT32(sign * IQ24(8.0), asked.q);
    }
}

/* "Sets voltage and integrators to zero." */
static void test_stopped(void)
{
    fill();
    const iqfoc_command_t off = iqfoc_cycle_stopped(&cycle);
    TEST_ASSERT_EQUAL_INT64(0, cycle.control.integral_d | cycle.control.integral_q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.u_ab.alpha | cycle.u_ab.beta | cycle.u_dq.d | cycle.u_dq.q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.drift.d | cycle.drift.q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.duties_next.a | cycle.duties_next.b | cycle.duties_next.c);
    for (int k = 0; k < 2; k++) {
        config.safe_state = k == 0 ? IQFOC_SAFE_GATES_OFF : IQFOC_SAFE_SHORT_CIRCUIT;
        const iqfoc_command_t safe = iqfoc_cycle_safe(&config);
        TEST_ASSERT_EQUAL(k == 1, safe.gates);
        TEST_ASSERT_EQUAL_INT32(0, safe.duties.high.a | safe.duties.high.b | safe.duties.high.c);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE, safe.duties.scale);
    }
    TEST_ASSERT_FALSE(off.gates);
}

static void test_what_trips(void)
{
    config.trips = 0x0C;
    iqfoc_cycle_set_status(&cycle, 0x13);
    TEST_ASSERT_EQUAL_UINT32(0x13, cycle.status);
    TEST_ASSERT_FALSE(cycle.tripped);
    iqfoc_cycle_set_status(&cycle, 0x14);
    TEST_ASSERT_EQUAL_UINT32(0x17, cycle.status);
    TEST_ASSERT_TRUE(cycle.tripped);
    iqfoc_cycle_set_status(&cycle, 0x10); /* which does not end the trip */
    TEST_ASSERT_TRUE(cycle.tripped);
}

/* Status bits of one faulty sample, everything else good; `now` as long after it as it may be. */
static uint32_t status_of(iqfoc_sample_t s, uint32_t age)
{
    iqfoc_cycle_clear(&cycle);
    s.time = ticks;
    iqfoc_cycle_report_sample(&cycle, &s, ticks + age);
    return cycle.status;
}

/* The current's vector of a sample along alpha, or along beta. */
static iqfoc_sample_t with_current(iq24_t alpha, iq24_t beta)
{
    iqfoc_sample_t s = sample_at(0);
    s.i = iqfoc_clarke_inverse((iqfoc_ab_t){alpha, beta});
    return s;
}

static void test_each_fault_to_its_limit(void)
{
    iqfoc_sample_t s = sample_at(0);
    TEST_ASSERT_EQUAL_UINT32(0, status_of(s, config.stale_ticks));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_STALE, status_of(s, config.stale_ticks + 1));
    s.clipped = true;
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_SAMPLE_CLIPPED, status_of(s, 0));
    for (int way = -1; way <= 1; way += 2) {
        s = sample_at(0);
        s.speed = way * IQFOC_ROTOR_SPEED_MAX;
        TEST_ASSERT_EQUAL_UINT32(0, status_of(s, 0));
        s.speed += way;
        TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERSPEED, status_of(s, 0));
        for (int off = -3; off <= 3; off++) {
            const iq24_t size = way * (config.current_limit + off);
            const iqfoc_sample_t along = with_current(size, 0);
            const iqfoc_sample_t across = with_current(0, size);
            const iqfoc_ab_t i_along = iqfoc_clarke3(along.i);
            const iqfoc_ab_t i_across = iqfoc_clarke3(across.i);
            TEST_ASSERT_EQUAL_UINT32(labs(i_along.alpha) > config.current_limit ? IQFOC_STATUS_OVERCURRENT
                                                                                : 0,
                                     status_of(along, 0));
            TEST_ASSERT_EQUAL_UINT32(labs(i_across.beta) > config.current_limit ? IQFOC_STATUS_OVERCURRENT
                                                                                : 0,
                                     status_of(across, 0));
        }
    }
    s = sample_at(0);
    s.u_dc = IQ24(0.5);
    TEST_ASSERT_EQUAL_UINT32(0, status_of(s, 0));
    s.u_dc--;
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_DC_LINK, status_of(s, 0));
    s.u_dc = IQ24(1.5);
    TEST_ASSERT_EQUAL_UINT32(0, status_of(s, 0));
    s.u_dc++;
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_DC_LINK, status_of(s, 0));
    config.period_ticks = 0;
    config.time_unchecked = true; /* "switches the checks of time off" */
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_DC_LINK, status_of(s, config.stale_ticks + 1));
}

/* A valley in order is whole and leaves the prediction; any other makes the sample the prediction. */
static void expect_valley(uint32_t phase, uint32_t since, bool whole, uint32_t status)
{
    const iqfoc_sample_t s = with_current(IQ24(0.3), IQ24(-0.2));
    const iqfoc_ab_t i = iqfoc_clarke3(s.i);
    iqfoc_cycle_clear(&cycle);
    cycle.phase = phase;
    cycle.valley_time = s.time - since;
    cycle.i_next.alpha = 12;
    cycle.i_next.beta = 13;
    TEST_ASSERT_EQUAL(whole, iqfoc_cycle_report_valley(&cycle, &s, ticks));
    TEST_ASSERT_EQUAL_UINT32(status, cycle.status);
    TEST_ASSERT_EQUAL_INT32(whole ? 12 : i.alpha, cycle.i_next.alpha);
    TEST_ASSERT_EQUAL_INT32(whole ? 13 : i.beta, cycle.i_next.beta);
}

static void test_valleys_in_order_and_not(void)
{
    const uint32_t longest = PERIOD + PERIOD / 100;
    expect_valley(IQFOC_CYCLE_DUE_VALLEY, longest, true, 0);
    expect_valley(IQFOC_CYCLE_DUE_VALLEY, longest + 1, false, IQFOC_STATUS_MISSED);
    expect_valley(IQFOC_CYCLE_DUE_PEAK, PERIOD, false, IQFOC_STATUS_MISSED);
    expect_valley(IQFOC_CYCLE_DUE_NOTHING, 10 * PERIOD, false, 0);
    config.period_ticks = 0;
    config.time_unchecked = true;
    expect_valley(IQFOC_CYCLE_DUE_VALLEY, 10 * PERIOD, true, 0);
    expect_valley(IQFOC_CYCLE_DUE_PEAK, 10 * PERIOD, false, IQFOC_STATUS_MISSED);
}

static void test_peaks_in_order_and_not(void)
{
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    for (int due = 0; due < 2; due++) {
        iqfoc_cycle_clear(&cycle);
        cycle.phase = due ? IQFOC_CYCLE_DUE_PEAK : IQFOC_CYCLE_DUE_VALLEY;
        cycle.corrected = true;
        iqfoc_cycle_report_peak(&cycle, &s, ticks);
        TEST_ASSERT_EQUAL_UINT32(due ? 0 : IQFOC_STATUS_MISSED, cycle.status);
        TEST_ASSERT_EQUAL(due, cycle.corrected);
    }
}

/* In time to the last tick; late, and where that trips nothing is left of the voltage. */
static void test_late_to_the_tick(void)
{
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    cycle.u_ab.alpha = 5;
    TEST_ASSERT_TRUE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks));
    config.trips = 0;
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks + 1));
    TEST_ASSERT_EQUAL_INT32(5, cycle.u_ab.alpha);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LATE, cycle.status);
    config.trips = IQFOC_STATUS_LATE;
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks + 1));
    TEST_ASSERT_EQUAL_INT32(0, cycle.u_ab.alpha);
}

/* The part of output_mid beyond the first cycle is scaled by next period over present period, held to 0 ... 8. */
static void test_scaled_output(void)
{
    uint64_t seed = 1;
    iqfoc_cycle_config_t other = base_config;
    cycle.next = &other;
    for (int n = 0; n < 100000 / IQFOC_TEST_STRIDE; n++) {
        const iq24_t mid = random_iq24(&seed, 0.0, n % 2 == 0 ? 8.0 : 1.1);
        config.period_ticks = (uint32_t)bits_random(&seed, 1, 100000);
        other.period_ticks = n % 10 == 0 ? config.period_ticks : (uint32_t)bits_random(&seed, 1, 100000);
        int64_t want = mid;
        if (mid > IQ24_ONE && other.period_ticks != config.period_ticks) {
            const int64_t longer =
                bits_held(bits_quotient(other.period_ticks, config.period_ticks), 0, INT32_MAX);
            want = bits_held(IQ24_ONE + bits_held(bits_product(mid - IQ24_ONE, longer), 0, INT32_MAX), 0,
                             8 * (int64_t)IQ24_ONE);
        }
        TEST_ASSERT_EQUAL_INT64(want, iqfoc_cycle_output_mid_scaled(&cycle, mid));
    }
}

/* Deprecated names: each still compiles and does what the new name does. */
static void test_deprecated_names(void)
{
    const iqfoc_methods_t over = {.modulation = IQFOC_MODULATION_OVER};
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_t same = cycle;
    const iqfoc_dq_t old = iqfoc_cycle_asked(over, &cycle, &config, IQ24(0.25));
    const iqfoc_dq_t u = iqfoc_cycle_pi_voltage(over, &same, &config, IQ24(0.25));
    TEST_ASSERT_EQUAL_INT32(u.d, old.d);
    TEST_ASSERT_EQUAL_INT32(u.q, old.q);
    TEST_ASSERT_EQUAL(iqfoc_cycle_report_valley(&same, &s, ticks), iqfoc_cycle_odd_valley(&cycle, &s, ticks));
    iqfoc_cycle_report_sample(&same, &s, ticks);
    iqfoc_cycle_odd_sample(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL(iqfoc_cycle_report_peak(&same, &s, ticks), iqfoc_cycle_odd_peak(&cycle, &s, ticks));
    TEST_ASSERT_EQUAL_UINT32(same.status, cycle.status);
    TEST_ASSERT_EQUAL_INT32(iqfoc_cycle_output_mid_scaled(&same, IQ24(1.5)),
                            iqfoc_cycle_stretched(&cycle, IQ24(1.5)));

    const iqfoc_observer_t observer = {.speed_q32 = INT32_C(0x12345678)};
    const iqfoc_tracker_t tracker = {.speed_q32 = INT32_C(-0x12345678)};
    TEST_ASSERT_EQUAL_INT32(iqfoc_observer_speed(&observer), iqfoc_observer_turns(&observer));
    TEST_ASSERT_EQUAL_INT32(iqfoc_tracker_speed(&tracker), iqfoc_tracker_turns(&tracker));
    TEST_ASSERT_EQUAL_INT32(iqfoc_rotor_from_speed(IQ24(0.2)).phi_s1,
                            iqfoc_rotor_from_turns(IQ24(0.2)).phi_s1);
    TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_TURNS_MAX);
    TEST_ASSERT_EQUAL_INT32(IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_TURNS_MAX);
    TEST_ASSERT_EQUAL_INT32(IQFOC_PATTERN_CONTROL_SPEED_MIN, IQFOC_PATTERN_CONTROL_TURNS_MIN);
    TEST_ASSERT_EQUAL_INT32(IQFOC_SPEED(6000.0, 3, 1e-4), IQFOC_TURNS(6000.0, 3, 1e-4));
}

/* The ready-made cycle is the steps with the papers' methods, whatever its configuration names. */
static void test_ready_made_is_by_methods(void)
{
    static const iqfoc_feedback_t feedback[3] = {IQFOC_FEEDBACK_MIDPOINT, IQFOC_FEEDBACK_CORRECTED_MEAN,
                                                 IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN};
    for (int k = 0; k < 6; k++) {
        config.feedback = feedback[k % 3];
        config.modulation = k < 3 ? IQFOC_MODULATION_PWM : IQFOC_MODULATION_SIX_STEP;
        const iqfoc_methods_t m = {IQFOC_MODEL_QUASI_DISCRETE, config.feedback, IQFOC_CONTROL_PI,
                                   config.modulation, false};
        iqfoc_cycle_t by;
        setUp();
        config.feedback = m.feedback;
        config.modulation = m.modulation;
        cycle.enabled = true;
        cycle.i_ref.q = IQ24(0.4);
        by = cycle;
        for (int n = 0; n < 5; n++) {
            iqfoc_sample_t s = with_current(IQ24(0.1) * n, IQ24(0.05));
            iqfoc_cycle_valley(&cycle, &s, ticks);
            iqfoc_cycle_valley_by(m, &by, &s, ticks);
            ticks += PERIOD / 2;
            s.time = ticks;
            s.instant = IQ24(0.5);
            const iqfoc_command_t got = iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
            const iqfoc_command_t want = iqfoc_cycle_peak_by(m, &by, &s, IQ24(1.5), ticks);
            ticks += PERIOD / 2;
            TEST_ASSERT_EQUAL_INT32(want.duties.high.a, got.duties.high.a);
            TEST_ASSERT_EQUAL_INT32(want.duties.high.b, got.duties.high.b);
            TEST_ASSERT_EQUAL_INT32(want.duties.high.c, got.duties.high.c);
            TEST_ASSERT_EQUAL(want.gates, got.gates);
            TEST_ASSERT_EQUAL_UINT32(by.status, cycle.status);
            TEST_ASSERT_EQUAL_INT32(by.i_dq.d, cycle.i_dq.d);
            TEST_ASSERT_EQUAL_INT32(by.i_dq.q, cycle.i_dq.q);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_fresh_cycle);
    RUN_TEST(test_bits_and_the_least_factor);
    RUN_TEST(test_clear);
    RUN_TEST(test_no_interval_after_clearing);
    RUN_TEST(test_the_guards_limits);
    RUN_TEST(test_the_guard_by_phases);
    RUN_TEST(test_voltage_is_what_the_duties_make);
    RUN_TEST(test_asked_is_held_to_eight);
    RUN_TEST(test_stopped);
    RUN_TEST(test_what_trips);
    RUN_TEST(test_each_fault_to_its_limit);
    RUN_TEST(test_valleys_in_order_and_not);
    RUN_TEST(test_peaks_in_order_and_not);
    RUN_TEST(test_late_to_the_tick);
    RUN_TEST(test_scaled_output);
    RUN_TEST(test_deprecated_names);
    RUN_TEST(test_ready_made_is_by_methods);
    return UNITY_END();
}

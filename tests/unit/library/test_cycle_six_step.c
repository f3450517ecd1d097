/*
 * Six-step by a timer: order and duration of the states, the angle's integrator, the safe output, and the way back to
 * the carrier. In closed loop: test_loops.c.
 */
#include "iqfoc/cycle_six_step.h"
#include "iqfoc/cycle_steps.h"

#include "cycle_fixture.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static const iqfoc_six_step_config_t angles = {IQ24(0.01), 0, IQ24(0.5), false};
static const iqfoc_six_step_config_t backwards = {IQ24(0.01), IQ24(-0.5), 0, false};
static iqfoc_six_step_t six;

static iqfoc_sample_t still(iq24_t theta, iq24_t speed)
{
    iqfoc_sample_t s = sample_at(0);
    s.theta = theta;
    s.speed = speed;
    s.has_mean = true;
    return s;
}

/* The rotor turns to each switching instant: the states come in order, each a sixth of a turn, as time and angle, and
 * the voltage of each has its sector's middle half a sector after the switching. */
static void states_in_order(const iqfoc_six_step_config_t *c, iq24_t speed, iq24_t angle)
{
    iq24_t theta = IQ24(0.3);
    iqfoc_sample_t s = still(theta, speed);
    cycle.enabled = true;
    iqfoc_six_step_command_t next = iqfoc_cycle_six_step_begin(&six, &cycle, c, angle, &s);
    int32_t before = six.state;
    for (int32_t n = 0; n < 50; n++) {
        theta = iq24_add_wrap(theta, speed < 0 ? -next.movement : next.movement);
        s = still(theta, speed);
        s.i_mean.a = 0;
        cycle.i_ref.q = cycle.i_dq.q; /* no error */
        next = iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
        cycle.i_ref.q = 0;
        TEST_ASSERT_EQUAL_INT32((before + (speed < 0 ? 5 : 1)) % 6, six.state);
        before = six.state;
        TEST_ASSERT_INT32_WITHIN(4, IQ24_ONE / 6, next.movement);
        const double want = (double)next.movement / abs(speed) * PERIOD;
        TEST_ASSERT_DOUBLE_WITHIN(1.0, want, next.ticks);
        TEST_ASSERT_TRUE(next.command.gates);
        const iqfoc_ab_t u = cycle.u_now;
        const iq24_t ahead = iq24_sub_wrap(iq24_atan2(u.beta, u.alpha), theta) - angle;
        const int32_t part = ahead & 0xFFFFFF; /* the state's vector, half a sector ahead of the voltage */
        TEST_ASSERT_INT32_WITHIN(8, speed < 0 ? IQ24_ONE - IQ24_ONE / 12 : IQ24_ONE / 12, part);
    }
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

static void test_forward(void)
{
    states_in_order(&angles, IQ24(0.02), IQ24(0.27));
}

static void test_backward(void)
{
    states_in_order(&backwards, IQ24(-0.03), IQ24(-0.2));
}

/* The angle rises by the gain times the error, to its limits; without means of the phases it stays. */
static void test_integrator(void)
{
    iqfoc_sample_t s = still(0, IQ24(0.02));
    cycle.enabled = true;
    (void)iqfoc_cycle_six_step_begin(&six, &cycle, &angles, IQ24(0.25), &s);
    cycle.i_ref.q = IQ24(0.5);
    (void)iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
    TEST_ASSERT_INT32_WITHIN(1, IQ24(0.255), iq24_acc_round(six.angle));
    s.has_mean = false;
    (void)iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
    TEST_ASSERT_INT32_WITHIN(1, IQ24(0.255), iq24_acc_round(six.angle));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_NO_INTERVAL, cycle.status);
    s.has_mean = true;
    cycle.i_ref.q = IQ24(32.0);
    (void)iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), iq24_acc_round(six.angle));
    cycle.i_ref.q = IQ24(-32.0);
    for (int32_t n = 0; n < 3; n++) {
        (void)iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
    }
    TEST_ASSERT_EQUAL_INT32(0, iq24_acc_round(six.angle));
}

/* 2016: the mean of a current that stands still in the rotor frame is turned and shortened; corrected it is that. */
static void test_feedback(void)
{
    const double i_q = 0.4;
    const double pi = 3.14159265358979323846;
    for (int discrete = 0; discrete < 2; discrete++) {
        iqfoc_six_step_config_t c = angles;
        c.discrete_angle = discrete == 1;
        iqfoc_sample_t s = still(0, IQ24(0.02));
        s.i = iqfoc_clarke_inverse((iqfoc_ab_t){0, IQ24(0.4)});
        cycle.enabled = true;
        (void)iqfoc_cycle_six_step_begin(&six, &cycle, &c, IQ24(0.25), &s);
        const double phi = 2.0 * pi / 6.0;
        s = still(IQ24_ONE / 6, IQ24(0.02));
        s.i = iqfoc_clarke_inverse((iqfoc_ab_t){IQ24(-0.4 * 0.86602540378), IQ24(0.4 * 0.5)});
        /* The mean of a straight line between both ends. */
        s.i_mean = iqfoc_clarke_inverse((iqfoc_ab_t){IQ24(-0.2 * 0.86602540378), IQ24(0.2 * 1.5)});
        (void)iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
        const double s1 = sin(phi / 2) / (phi / 2);
        const double want = discrete == 1 ? i_q * cos(phi / 2) : i_q * s1 * s1;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, want, to_double(cycle.i_dq.q));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, to_double(cycle.i_dq.d));
    }
}

static void test_safe_output(void)
{
    iqfoc_sample_t s = still(0, IQ24(0.02));
    iqfoc_six_step_config_t bad = angles;
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_begin(&six, &cycle, &angles, IQ24(0.25), &s).command.gates);
    cycle.enabled = true;
    TEST_ASSERT_TRUE(iqfoc_cycle_six_step_begin(&six, &cycle, &angles, IQ24(0.25), &s).command.gates);
    s.i.a = IQ24(3.0);
    s.i.b = IQ24(-3.0);
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks).command.gates);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERCURRENT, cycle.status);
    s = still(0, IQ24(0.02));
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks).command.gates);
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_TRUE(iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks).command.gates);
    bad.gain = IQ24_ONE + 1;
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_begin(&six, &cycle, &bad, IQ24(0.25), &s).command.gates);
    TEST_ASSERT_NULL(six.config);
    bad = angles;
    bad.angle_max = bad.angle_min;
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_begin(&six, &cycle, &bad, IQ24(0.25), &s).command.gates);
    TEST_ASSERT_FALSE(iqfoc_cycle_six_step_begin(&six, &cycle, NULL, IQ24(0.25), &s).command.gates);
}

/* At standstill the interval is the longest; at any speed the times fit. */
static void test_standstill(void)
{
    iqfoc_sample_t s = still(0, 0);
    cycle.enabled = true;
    const iqfoc_six_step_command_t first = iqfoc_cycle_six_step_begin(&six, &cycle, &angles, IQ24(0.25), &s);
    TEST_ASSERT_DOUBLE_WITHIN(PERIOD, 128.0 * PERIOD, first.ticks);
    TEST_ASSERT_EQUAL_INT32(iqfoc_cycle_voltage_angle(&cycle), 0);
}

/* Back at the carrier the first voltage is six-step's fundamental: its length and its angle to the rotor. */
static void test_back_to_the_carrier(void)
{
    static const iqfoc_methods_t methods = {IQFOC_MODEL_QUASI_DISCRETE, IQFOC_FEEDBACK_MIDPOINT,
                                            IQFOC_CONTROL_PI, IQFOC_MODULATION_OVER, false};
    iqfoc_sample_t s = still(0, IQ24(0.02));
    cycle.enabled = true;
    (void)iqfoc_cycle_six_step_begin(&six, &cycle, &angles, IQ24(0.3), &s);
    iqfoc_cycle_six_step_end(&six, &cycle, s.speed);
    TEST_ASSERT_INT32_WITHIN(16, IQ24(0.3), iqfoc_cycle_voltage_angle(&cycle));
    iqfoc_cycle_valley_by(methods, &cycle, &s, ticks);
    ticks += PERIOD / 2;
    s = sample_at(IQ24(0.5));
    TEST_ASSERT_TRUE(iqfoc_cycle_peak_by(methods, &cycle, &s, IQ24(1.5), ticks).gates);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    TEST_ASSERT_INT32_WITHIN(1 << 12, IQ24(0.3), iqfoc_cycle_voltage_angle(&cycle));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.63662, hypot(to_double(cycle.u_dq.d), to_double(cycle.u_dq.q)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_forward);
    RUN_TEST(test_backward);
    RUN_TEST(test_integrator);
    RUN_TEST(test_feedback);
    RUN_TEST(test_safe_output);
    RUN_TEST(test_standstill);
    RUN_TEST(test_back_to_the_carrier);
    return UNITY_END();
}

/*
 * Six-step to the last bit: the state nearest to an angle and the remaining angle, and six-step by a timer against
 * the lines of its header in integers. test_cycle_six_step.c checks the order of the states and the loop.
 */
/* Ahead of the fixture, whose names theirs would hide. */
#include "iqfoc/cycle_guard.h"
#include "iqfoc/cycle_six_step.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"

#include "bits.h"
#include "cycle_fixture.h"

#include <stdbool.h>

#define DRAWS (30000 / IQFOC_TEST_STRIDE)

/* An angle's turn, -1/2 ... 1/2. */
static int64_t within_turn(int64_t angle)
{
    return angle - bits_floor(angle + IQ24_ONE / 2, IQ24_ONE) * IQ24_ONE;
}

/* ---- Angle to state ---- */

/* Six times the angle in LSB, from the lower border of state 0. */
static int64_t sixths(int64_t angle)
{
    const int64_t within = angle - bits_floor(angle, IQ24_ONE) * IQ24_ONE;
    return 6 * within + IQ24_ONE / 2;
}

static void expect_state(iq24_t angle)
{
    const int64_t place = sixths(angle);
    const int64_t rest = place % IQ24_ONE;
    TEST_ASSERT_EQUAL_INT64(place / IQ24_ONE % 6, iqfoc_six_step_state(angle));
    /* Forward the next border is to be reached, backward this one passed: whole LSB. */
    TEST_ASSERT_EQUAL_INT64(bits_floor(IQ24_ONE - rest + 5, 6), iqfoc_six_step_remaining(angle, 0));
    TEST_ASSERT_EQUAL_INT64(bits_floor(IQ24_ONE - rest + 5, 6), iqfoc_six_step_remaining(angle, 1));
    TEST_ASSERT_EQUAL_INT64(rest / 6 + 1, iqfoc_six_step_remaining(angle, -1));
}

static void test_states_of_angles(void)
{
    uint64_t seed = 1;
    for (int n = 0; n < DRAWS; n++) {
        expect_state(bits_random(&seed, INT32_MIN, INT32_MAX));
    }
    for (int64_t border = -12; border <= 24; border++) {
        for (int64_t off = -3; off <= 3; off++) {
            expect_state((iq24_t)(border * (IQ24_ONE / 12) + off));
        }
    }
}

/* State k: 100 110 010 011 001 101, and its vector (2/3) u_dc e^(j k pi/3). */
static void test_legs_and_voltage_of_states(void)
{
    static const int legs[6][3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
    uint64_t seed = 2;
    for (int n = 0; n < 2000; n++) {
        for (int32_t state = -2; state < 8; state++) {
            const bool is_one = state >= 0 && state < 6;
            const int *leg = legs[is_one ? state : 0];
            const iq24_t u_dc = bits_random(&seed, -64 * IQ24_ONE, 64 * IQ24_ONE);
            const int64_t third = bits_product_of(u_dc, llround(ldexp(1.0 / 3.0, 31)), 31);
            const int64_t over_root = bits_product_of(u_dc, llround(ldexp(1.0 / sqrt(3.0), 31)), 31);
            const iqfoc_duties_t d = iqfoc_six_step_duties(state);
            const iqfoc_ab_t u = iqfoc_six_step_voltage(state, u_dc);
            TEST_ASSERT_EQUAL_INT32(is_one ? leg[0] * IQ24_ONE : 0, d.high.a);
            TEST_ASSERT_EQUAL_INT32(is_one ? leg[1] * IQ24_ONE : 0, d.high.b);
            TEST_ASSERT_EQUAL_INT32(is_one ? leg[2] * IQ24_ONE : 0, d.high.c);
            TEST_ASSERT_EQUAL_INT32(IQ24_ONE, d.scale);
            TEST_ASSERT_EQUAL_INT64(is_one ? (2 * leg[0] - leg[1] - leg[2]) * third : 0, u.alpha);
            TEST_ASSERT_EQUAL_INT64(is_one ? (leg[1] - leg[2]) * over_root : 0, u.beta);
        }
    }
}

/* ---- By a timer ---- */

static struct {
    int64_t angle; /* Q48 */
    int state;
    iqfoc_sample_t begin;
    int64_t u_dc;
} model;

static int64_t clamped(const iqfoc_six_step_config_t *c, int64_t angle)
{
    return bits_held(angle, c->angle_min * (int64_t)IQ24_ONE, c->angle_max * (int64_t)IQ24_ONE);
}

static void expect_standing(const iqfoc_six_step_command_t *got, iq24_t theta, iq24_t turns)
{
    const bool back = turns < 0;
    const int64_t border = (2 * model.state + (back ? -1 : 1)) * (int64_t)(IQ24_ONE / 2) / 6;
    const int64_t rest = within_turn(border - (theta + bits_nearest(model.angle, 24)));
    const int64_t way = bits_held(back ? -rest : rest, IQ24_ONE / 600, IQ24_ONE / 3);
    const int64_t speed = turns == 0 ? 1 : turns < 0 ? -(int64_t)turns : turns;
    const int64_t cycles = bits_held(bits_quotient(way, speed), 0, INT32_MAX);
    const iqfoc_ab_t u = iqfoc_six_step_voltage(model.state, (iq24_t)model.u_dc);
    TEST_ASSERT_TRUE(got->command.gates);
    TEST_ASSERT_EQUAL_INT64(way, got->turns);
    TEST_ASSERT_EQUAL_INT64(
        bits_held(bits_floor(cycles * (int64_t)config.period_ticks, IQ24_ONE), 0, UINT32_MAX), got->ticks);
    const iqfoc_duties_t d = iqfoc_six_step_duties(model.state);
    TEST_ASSERT_EQUAL_MEMORY(&d, &got->command.duties, sizeof d);
    TEST_ASSERT_EQUAL_MEMORY(&u, &cycle.u_now, sizeof u);
    TEST_ASSERT_EQUAL_MEMORY(&u, &cycle.u_ab, sizeof u);
}

static void expect_taken(const iqfoc_six_step_t *six, const iqfoc_sample_t *s)
{
    const iqfoc_ab_t i = iqfoc_clarke3(s->i);
    TEST_ASSERT_EQUAL_INT32(s->theta, six->theta_begin);
    TEST_ASSERT_EQUAL_MEMORY(&i, &six->i_begin, sizeof i);
    TEST_ASSERT_EQUAL_INT64(model.u_dc, six->u_dc);
    TEST_ASSERT_EQUAL_INT64(model.angle, six->angle);
    TEST_ASSERT_EQUAL_INT32(model.state, six->state);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_CYCLE_DUE_NOTHING, cycle.phase);
    TEST_ASSERT_EQUAL_MEMORY(&i, &cycle.i_valley, sizeof i);
    TEST_ASSERT_EQUAL_INT32(s->theta, cycle.theta_valley);
}

static iqfoc_sample_t any_sample(uint64_t *seed, iq24_t theta, iq24_t turns)
{
    const iqfoc_sample_t s = {
        .i = {random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0)},
        .i_mean = {random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0)},
        .has_mean = bits_random(seed, 0, 5) > 0,
        .theta = theta,
        .turns = turns,
        .u_dc = random_iq24(seed, 0.4, 1.6),
        .time = ticks};
    return s;
}

static void take(const iqfoc_sample_t *s)
{
    model.begin = *s;
    model.u_dc = bits_held(s->u_dc, IQ24_ONE / 2, IQ24_ONE + IQ24_ONE / 2);
}

/* The mean seen from the rotor's middle, corrected or not, and the integrator. */
static void integrate(const iqfoc_six_step_config_t *c, const iqfoc_sample_t *s)
{
    const iqfoc_ab_t i = iqfoc_clarke3(s->i);
    const iqfoc_ab_t before = iqfoc_clarke3(model.begin.i);
    const iqfoc_ab_t delta = {i.alpha - before.alpha, i.beta - before.beta};
    const int64_t covered = bits_held(within_turn((int64_t)s->theta - model.begin.theta),
                                      -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
    const iq24_sincos_t middle = iq24_sincos(iq24_wrap(model.begin.theta + bits_floor(covered, 2)));
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns((iq24_t)covered);
    const iqfoc_ab_t mean = iqfoc_clarke3(s->i_mean);
    const iqfoc_dq_t seen = c->discrete_angle ? iqfoc_park(mean, middle)
                                              : iqfoc_mean_current_correct(mean, delta, &rotor, middle);
    TEST_ASSERT_EQUAL_MEMORY(&seen, &cycle.i_dq, sizeof seen);
    model.angle = clamped(c, model.angle + c->gain * ((int64_t)cycle.i_ref.q - seen.q));
}

static void test_by_a_timer(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < DRAWS / 10; n++) {
        const iq24_t low = random_iq24(&seed, -0.5, 0.3);
        const iqfoc_six_step_config_t c = {bits_random(&seed, 0, IQ24_ONE / 8), low,
                                           random_iq24(&seed, 0.31, 0.5), n % 3 == 0};
        const double most = n % 4 == 0 ? 0.33 : n % 4 == 1 ? 1e-6 : 0.05;
        iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        iqfoc_six_step_t six;
        setUp();
        config.current_limit = IQ24(16.0);
        config.period_ticks = (uint32_t)bits_random(&seed, 1, n % 2 == 0 ? 100000 : INT32_MAX - 1000);
        cycle.enabled = true;
        cycle.i_ref.q = random_iq24(&seed, -1.0, 1.0);
        const iq24_t angle = bits_random(&seed, INT32_MIN, INT32_MAX);
        iqfoc_sample_t s = any_sample(&seed, theta, random_iq24(&seed, -most, most));
        model.angle = clamped(&c, within_turn(angle) * (int64_t)IQ24_ONE);
        model.state = iqfoc_six_step_state(iq24_wrap(s.theta + bits_nearest(model.angle, 24)));
        take(&s);
        iqfoc_six_step_command_t got = iqfoc_cycle_six_step_begin(&six, &cycle, &c, angle, &s);
        TEST_ASSERT_TRUE(six.config == &c);
        expect_standing(&got, s.theta, s.turns);
        expect_taken(&six, &s);
        for (int k = 0; k < 8; k++) {
            theta = iq24_wrap((int64_t)theta + random_iq24(&seed, -0.4, 0.4));
            s = any_sample(&seed, theta, random_iq24(&seed, -most, most));
            iqfoc_cycle_clear(&cycle);
            got = iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
            if (s.has_mean) {
                integrate(&c, &s);
            }
            take(&s);
            model.state = (model.state + (s.turns < 0 ? 5 : 1)) % 6;
            const bool link = s.u_dc < IQ24(0.5) || s.u_dc > IQ24(1.5);
            TEST_ASSERT_EQUAL_UINT32((s.has_mean ? 0 : IQFOC_STATUS_NO_INTERVAL) |
                                         (link ? IQFOC_STATUS_DC_LINK : 0),
                                     cycle.status);
            expect_standing(&got, s.theta, s.turns);
            expect_taken(&six, &s);
        }
        /* Back to PWM: (2/pi) u_dc at this angle minus the decoupling. */
        const iq24_t turns = random_iq24(&seed, -0.5, 0.5);
        const iqfoc_dq_t apart = iqfoc_current_control_decoupling(
            &config.gains, cycle.i_ref,
            (iq24_t)bits_held(turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX));
        const int64_t u = bits_product(llround(ldexp(4.0 / TWO_PI, 24)), model.u_dc);
        const iq24_sincos_t sc = iq24_sincos((iq24_t)bits_nearest(model.angle, 24));
        cycle.phase = IQFOC_CYCLE_DUE_PEAK;
        iqfoc_cycle_six_step_end(&six, &cycle, turns);
        TEST_ASSERT_EQUAL_INT64(bits_product(u, sc.cos), cycle.u_dq.d);
        TEST_ASSERT_EQUAL_INT64(bits_product(u, sc.sin), cycle.u_dq.q);
        TEST_ASSERT_EQUAL_INT64(
            iqfoc_current_control_hold(((int64_t)cycle.u_dq.d - apart.d) * (int64_t)IQ24_ONE),
            cycle.control.integral_d);
        TEST_ASSERT_EQUAL_INT64(
            iqfoc_current_control_hold(((int64_t)cycle.u_dq.q - apart.q) * (int64_t)IQ24_ONE),
            cycle.control.integral_q);
        TEST_ASSERT_EQUAL_INT32(llround(ldexp(4.0 / TWO_PI, 24)), cycle.over.length);
        TEST_ASSERT_EQUAL_UINT32(IQFOC_CYCLE_DUE_NOTHING, cycle.phase);
        TEST_ASSERT_EQUAL_INT32(within_turn(iq24_atan2(cycle.u_dq.q, cycle.u_dq.d)),
                                iqfoc_cycle_voltage_angle(&cycle));
    }
}

/* Not enabled or tripped: the safe command for a period, and the angle stays. */
static void test_safe_while_it_may_not_run(void)
{
    const iqfoc_six_step_config_t c = {IQ24(0.1), 0, IQ24(0.5), false};
    const iqfoc_sample_t s = {.u_dc = IQ24_ONE, .has_mean = true, .time = ticks};
    for (int k = 0; k < 2; k++) {
        iqfoc_six_step_t six;
        iqfoc_sample_t now = s;
        setUp();
        now.time = ticks;
        cycle.enabled = k == 1;
        cycle.tripped = k == 1;
        iqfoc_six_step_command_t got = iqfoc_cycle_six_step_begin(&six, &cycle, &c, IQ24(0.25), &now);
        for (int call = 0; call < 2; call++) {
            TEST_ASSERT_FALSE(got.command.gates);
            TEST_ASSERT_EQUAL_UINT32(PERIOD, got.ticks);
            TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 600, got.turns);
            TEST_ASSERT_EQUAL_INT32(IQ24(0.25), iq24_acc_round(six.angle));
            cycle.i_ref.q = IQ24_ONE;
            got = iqfoc_cycle_six_step_switch(&six, &cycle, &now, ticks);
        }
        TEST_ASSERT_FALSE(iqfoc_cycle_six_step_begin(&six, &cycle, NULL, 0, &now).command.gates);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_states_of_angles);
    RUN_TEST(test_legs_and_voltage_of_states);
    RUN_TEST(test_by_a_timer);
    RUN_TEST(test_safe_while_it_may_not_run);
    return UNITY_END();
}

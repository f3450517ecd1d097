/*
 * Six-step to the last bit: the state nearest to an angle and the remaining angle, and six-step by a timer, by hashes
 * of the results, and by a timer in double precision too. test_modulation.c checks every angle, test_cycle_six_step.c
 * the order of the states and the loop.
 */
/* Ahead of the fixture, whose names theirs would hide. */
#include "iqfoc/cycle_six_step.h"

#include "bits.h"
#include "cycle_fixture.h"
#include "hash.h"

#define DRAWS 30000

/* ---- Angle to state ---- */

static void add_angle(uint64_t *digest, iq24_t angle)
{
    digest_add(digest, iqfoc_six_step_state(angle));
    for (int speed = -1; speed <= 1; speed++) {
        digest_add(digest, iqfoc_six_step_remaining(angle, speed));
    }
}

static void test_states_of_angles(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        add_angle(&digest, bits_random(&seed, INT32_MIN, INT32_MAX));
    }
    for (int64_t border = -12; border <= 24; border++) {
        for (int64_t off = -3; off <= 3; off++) {
            add_angle(&digest, (iq24_t)(border * (IQ24_ONE / 12) + off));
        }
    }
    bits_golden(UINT64_C(0xa71eb71dd6d97adb), digest);
}

/* None of -2, -1, 6 and 7 is a state. */
static void test_legs_and_voltage_of_states(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 2000; n++) {
        for (int32_t state = -2; state < 8; state++) {
            const iq24_t u_dc = bits_random(&seed, -64 * IQ24_ONE, 64 * IQ24_ONE);
            const iqfoc_duties_t d = iqfoc_six_step_duties(state);
            const iqfoc_ab_t u = iqfoc_six_step_voltage(state, u_dc);
            bits_add(&digest, &d, sizeof d);
            bits_add(&digest, &u, sizeof u);
        }
    }
    bits_golden(UINT64_C(0x6869b306c94c5ff8), digest);
}

/* ---- By a timer ---- */

static double per_unit(iq24_acc_t x)
{
    return ldexp((double)x, -48);
}

/* 128 cycles at most. The quotient is to half an LSB. */
static void expect_time(const iqfoc_six_step_command_t *got, iq24_t speed)
{
    const double period = (double)config.period_ticks;
    const double cycles = fmin(to_double(got->movement) / fmax(fabs(to_double(speed)), to_double(1)), 128.0);
    TEST_ASSERT_TRUE(got->command.gates);
    TEST_ASSERT_TRUE(got->movement >= IQ24_ONE / 600 && got->movement <= IQ24_ONE / 3);
    TEST_ASSERT_DOUBLE_WITHIN(1.0 + period * to_double(1), fmin(cycles * period, UINT32_MAX), got->ticks);
}

static void add_command(uint64_t *digest, const iqfoc_six_step_t *six, const iqfoc_six_step_command_t *got)
{
    digest_add(digest, got->movement);
    digest_add(digest, (int32_t)got->ticks);
    bits_add(digest, &got->command.duties, sizeof got->command.duties);
    bits_add(digest, &cycle.u_now, sizeof cycle.u_now);
    bits_add(digest, &cycle.u_ab, sizeof cycle.u_ab);
    bits_add(digest, &cycle.i_dq, sizeof cycle.i_dq);
    bits_add(digest, &cycle.i_valley, sizeof cycle.i_valley);
    digest_add(digest, cycle.theta_valley);
    digest_add(digest, (int32_t)cycle.phase);
    digest_add(digest, (int32_t)cycle.status);
    bits_add64(digest, six->angle);
    digest_add(digest, six->state);
    digest_add(digest, six->theta_begin);
    bits_add(digest, &six->i_begin, sizeof six->i_begin);
    digest_add(digest, six->u_dc);
}

static iqfoc_abc_t any_phases(uint64_t *seed)
{
    iqfoc_abc_t i;
    i.a = random_iq24(seed, -1.0, 1.0);
    i.b = random_iq24(seed, -1.0, 1.0);
    i.c = random_iq24(seed, -1.0, 1.0);
    return i;
}

static iqfoc_sample_t any_sample(uint64_t *seed, iq24_t theta, iq24_t speed)
{
    iqfoc_sample_t s = {.theta = theta, .speed = speed, .time = ticks};
    s.i = any_phases(seed);
    s.i_mean = any_phases(seed);
    s.has_mean = bits_random(seed, 0, 5) > 0;
    s.u_dc = random_iq24(seed, 0.4, 1.6);
    return s;
}

/* Back to PWM: (2/pi) u_dc at this angle minus the decoupling. */
static void end(uint64_t *digest, const iqfoc_six_step_t *six, iq24_t speed)
{
    const double u = 4.0 / TWO_PI * to_double(six->u_dc);
    const double angle = TWO_PI * per_unit(six->angle);
    cycle.phase = IQFOC_CYCLE_DUE_PEAK;
    iqfoc_cycle_six_step_end(six, &cycle, speed);
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(u * cos(angle)), cycle.u_dq.d);
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(u * sin(angle)), cycle.u_dq.q);
    bits_add(digest, &cycle.u_dq, sizeof cycle.u_dq);
    bits_add64(digest, cycle.control.integral_d);
    bits_add64(digest, cycle.control.integral_q);
    digest_add(digest, cycle.over.length);
    digest_add(digest, (int32_t)cycle.phase);
    digest_add(digest, iqfoc_cycle_voltage_angle(&cycle));
}

static void test_by_a_timer(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS / 10; n++) {
        iqfoc_six_step_config_t c;
        c.angle_min = random_iq24(&seed, -0.5, 0.3);
        c.gain = bits_random(&seed, 0, IQ24_ONE / 8);
        c.angle_max = random_iq24(&seed, 0.31, 0.5);
        c.discrete_angle = n % 3 == 0;
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
        cycle.phase = IQFOC_CYCLE_DUE_VALLEY;
        iqfoc_six_step_command_t got = iqfoc_cycle_six_step_begin(&six, &cycle, &c, angle, &s);
        TEST_ASSERT_TRUE(six.config == &c);
        expect_time(&got, s.speed);
        add_command(&digest, &six, &got);
        for (int k = 0; k < 8; k++) {
            const double before = per_unit(six.angle);
            theta = iq24_wrap((int64_t)theta + random_iq24(&seed, -0.4, 0.4));
            s = any_sample(&seed, theta, random_iq24(&seed, -most, most));
            iqfoc_cycle_clear(&cycle);
            got = iqfoc_cycle_six_step_switch(&six, &cycle, &s, ticks);
            const double error = to_double(cycle.i_ref.q) - to_double(cycle.i_dq.q);
            const double want = s.has_mean ? before + to_double(c.gain) * error : before;
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, fmin(fmax(want, to_double(c.angle_min)), to_double(c.angle_max)),
                                      per_unit(six.angle));
            expect_time(&got, s.speed);
            add_command(&digest, &six, &got);
        }
        end(&digest, &six, random_iq24(&seed, -0.5, 0.5));
    }
    bits_golden(UINT64_C(0xed338ec7e49c0a13), digest);
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
            TEST_ASSERT_EQUAL_INT32(IQ24_ONE / 600, got.movement);
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

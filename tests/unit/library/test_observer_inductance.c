/*
 * L_q of the observer from steps of the current (include/iqfoc/observer_inductance.h): each sentence of the header but
 * those of a drive, which test_sensorless.c has.
 */
#include "bits.h"
#include "iqfoc/observer_inductance.h"
#include "reference_vectors.h"

#include "unity.h"

#include <stddef.h>

static const iqfoc_observer_config_t nominal =
    IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.004));

static iqfoc_observer_inductance_config_t config;
static iqfoc_observer_inductance_t a;
static iqfoc_observer_t o;

void setUp(void)
{
    config = (iqfoc_observer_inductance_config_t){IQ24(0.05), IQ24(0.08), IQ24(0.003),
                                                  nominal.machine.l_q / 2, nominal.machine.l_q * 2};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &config, &nominal));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &a.adapted));
    o.locked = true;
    o.speed_q32 = INT32_C(1) << 29; /* 1/8 turn per cycle */
}

void tearDown(void)
{
}

static void step_with(double i_q, double error)
{
    const iqfoc_ab_t i = {0, to_iq24(i_q)};
    o.error = to_iq24(error);
    iqfoc_observer_inductance_step(&a, &o, i);
}

static double held(double x, double most)
{
    return fmax(-most, fmin(most, x));
}

/* The header's lines in double, from the same state: any state, current and error. */
static void test_step_is_that_of_its_lines(void)
{
    uint64_t seed = 31;
    long steps = 0;
    long held_steps = 0; /* by the voltage */
    for (int n = 0; n < 400000; n++) {
        iqfoc_observer_config_t c = nominal;
        c.machine.psi = random_iq24(&seed, 0.02, 16.0);
        config.gain = random_iq24(&seed, 1e-6, 1.0);
        config.least = random_iq24(&seed, 0.0625, 1.0);
        config.u_least = n % 4 == 0 ? random_iq24(&seed, 0.0, 1.0) : 0;
        config.low = nominal.machine.l_q / 8;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &config, &c));
        a.follows = true;
        a.level = random_iq24(&seed, -16.0, 16.0) / (n % 2 == 0 ? 1 : 16);
        a.slope = random_iq24(&seed, -8.0, 8.0) / (n % 2 == 0 ? 1 : 16);
        o.theta_q32 = (int32_t)random_iq24(&seed, -127.0, 127.0);
        o.speed_q32 = 256 * random_iq24(&seed, -0.33, 0.33);
        o.error = random_iq24(&seed, -0.5, 0.5) / (n % 3 == 0 ? 1 : 1000);
        const iqfoc_ab_t i = random_ab_in_square(&seed, n % 5 == 0 ? 15.9 : 1.0);
        const double theta = to_double(iqfoc_observer_theta(&o, 0));
        const double i_q = held(cimag(complex_of_ab(i) * cexp(-I * TWO_PI * theta)), 4.0);
        const double before = to_double(a.level) + to_double(a.slope);
        const double x = held(i_q - before, 8.0);
        const double level = held(before + to_double(c.k1) * x, 16.0);
        const double slope = held(to_double(a.slope) + to_double(c.k2) * x, 8.0);
        const double least = to_double(config.least);
        const double across = held(TWO_PI * to_double(c.machine.psi) * to_double(o.error), 8.0);
        const double step = to_double(config.gain) * across * x / (x * x + least * least);
        const double l_q =
            fmax(to_double(config.low), fmin(to_double(config.high), to_double(nominal.machine.l_q) + step));
        iqfoc_observer_inductance_step(&a, &o, i);
        const double lsb = 1.0 / 16777216.0;
        TEST_ASSERT_DOUBLE_WITHIN((4.0 + fabs(i_q)) * lsb, level, to_double(a.level));
        TEST_ASSERT_DOUBLE_WITHIN((4.0 + fabs(i_q)) * lsb, slope, to_double(a.slope));
        const double voltage =
            fmin(127.9, TWO_PI * fabs(o.speed_q32 / 4294967296.0 * to_double(nominal.machine.l_q) * x));
        const double u_least = to_double(config.u_least);
        if (fabs(fabs(x) - least) > 20.0 * lsb && fabs(voltage - u_least) > 100.0 * lsb) {
            const bool small = fabs(x) < least || voltage < u_least;
            const double expected = small ? to_double(nominal.machine.l_q) : l_q;
            const double bound =
                1e-5 * fabs(step) +
                (2.0 + to_double(config.gain) * (to_double(c.machine.psi) + 2.0) / (2.0 * least)) * lsb;
            TEST_ASSERT_DOUBLE_WITHIN(bound, expected, to_double(a.adapted.machine.l_q));
            steps += !small;
            held_steps += small && fabs(x) >= least;
        }
    }
    TEST_ASSERT_GREATER_THAN(100000, steps);
    TEST_ASSERT_GREATER_THAN(1000, held_steps);
}

/* e of a wrong L_q, as the header has it: the error of l_q decays in each cycle with |x| >= least, from either side. */
static void test_error_of_inductance_decays(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        const double true_l_q = to_double(nominal.machine.l_q) * (1.0 + 0.3 * sign);
        double last = fabs(to_double(a.adapted.machine.l_q) - true_l_q);
        for (int k = 0; k < 4000; k++) {
            const double i_q = k / 50 % 2 == 0 ? 0.0 : 0.8;
            const double x = i_q - to_double(a.level) - to_double(a.slope);
            const double d_l = to_double(a.adapted.machine.l_q) - true_l_q;
            step_with(i_q, a.follows ? -d_l * x / (TWO_PI * to_double(nominal.machine.psi)) : 0.0);
            const double now = fabs(to_double(a.adapted.machine.l_q) - true_l_q);
            TEST_ASSERT_TRUE(now <= last + 1e-6);
            last = now;
        }
        TEST_ASSERT_TRUE(last <= 1e-3 * true_l_q);
    }
}

static void test_holds_without_steps_of_the_current(void)
{
    for (int k = 0; k < 1000; k++) {
        step_with(0.5, 0.01); /* constant */
    }
    for (int k = 0; k < 1000; k++) {
        step_with(0.5 + 0.001 * k, 0.01); /* slow: a ramp is what the filter follows */
    }
    TEST_ASSERT_EQUAL_INT32(nominal.machine.l_q, a.adapted.machine.l_q);
}

/* The speed below which the voltage of these steps is below u_least: held at 0.9 of it, adapted at 1.1 of it. */
static void test_holds_below_a_speed(void)
{
    for (int n = 0; n < 2; n++) {
        setUp();
        const double least_turns = to_double(config.u_least) /
                                   (TWO_PI * 0.5 * to_double(nominal.machine.l_q)); /* |x| = 1/2 at most */
        o.speed_q32 = (int32_t)((n == 0 ? -0.9 : -1.1) * least_turns * 4294967296.0);
        step_with(0.0, 0.0);
        step_with(0.5, -0.001);
        TEST_ASSERT_EQUAL(n == 0, a.adapted.machine.l_q == nominal.machine.l_q);
    }
}

/* A step's voltage is at least u_least: to the last bit, from a filter at rest. */
static void test_least_voltage(void)
{
    uint64_t seed = 32;
    const int64_t two_pi = IQ24(6.283185307179586);
    for (int n = 0; n < 2000; n++) {
        o.speed_q32 = bits_random(&seed, -(INT32_C(1) << 28), INT32_C(1) << 28);
        const iq24_t x = bits_random(&seed, IQ24(0.1), IQ24(1.0)) * (n % 2 == 0 ? 1 : -1);
        const int64_t speed = bits_floor(two_pi * iqfoc_observer_speed(&o), IQ24_ONE);
        const int64_t flux = bits_floor((int64_t)nominal.machine.l_q * x, IQ24_ONE);
        const int64_t u = bits_product(speed, flux);
        config.u_least = (iq24_t)(u < 0 ? -u : u);
        for (int beyond = 0; beyond < 2; beyond++) {
            config.u_least += beyond;
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &config, &nominal));
            a.follows = true;
            step_with(to_double(x), 0.02);
            TEST_ASSERT_EQUAL(beyond != 0, a.adapted.machine.l_q == nominal.machine.l_q);
        }
    }
}

static void test_holds_while_the_observer_seeks(void)
{
    o.locked = false;
    for (int k = 0; k < 100; k++) {
        step_with(k % 2, 0.02);
    }
    TEST_ASSERT_EQUAL_INT32(nominal.machine.l_q, a.adapted.machine.l_q);
    TEST_ASSERT_FALSE(a.follows);
    o.locked = true;
    step_with(3.0, 0.02); /* the first locked step begins the filter at this current */
    TEST_ASSERT_EQUAL_INT32(nominal.machine.l_q, a.adapted.machine.l_q);
    step_with(0.0, 0.02);
    TEST_ASSERT_TRUE(a.adapted.machine.l_q < nominal.machine.l_q);
}

static void test_stays_within_its_bounds(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 2000; k++) {
            step_with(k / 10 % 2 == 0 ? 1.0 : -1.0, sign * (k / 10 % 2 == 0 ? 0.02 : -0.02));
        }
        TEST_ASSERT_EQUAL_INT32(sign < 0 ? config.low : config.high, a.adapted.machine.l_q);
    }
}

static iqfoc_error_t init_with(iq24_t gain, iq24_t least, iq24_t low, iq24_t high)
{
    const iqfoc_observer_inductance_config_t c = {gain, least, config.u_least, low, high};
    return iqfoc_observer_inductance_init(&a, &c, &nominal);
}

static void test_refuses_what_is_out_of_range(void)
{
    const iq24_t l = nominal.machine.l_q;
    iqfoc_observer_config_t wrong = nominal;
    wrong.k1 = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_inductance_init(NULL, &config, &nominal));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_inductance_init(&a, NULL, &nominal));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_inductance_init(&a, &config, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, iqfoc_observer_inductance_init(&a, &config, &wrong));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_with(1, IQ24(0.0625), 1, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_with(IQ24_ONE, IQ24_ONE, l, l + IQ24(4.0)));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(0, IQ24(0.1), l, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(IQ24_ONE + 1, IQ24(0.1), l, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.0625) - 1, l, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24_ONE + 1, l, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), 0, l));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), l + 1, l + 1));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), l, l - 1));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), l, l + IQ24(4.0) + 1));
    config.u_least = -1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), l, l));
    config.u_least = IQ24_ONE + 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.1), l, l));
    const iqfoc_observer_inductance_config_t most = {1, IQ24(0.1), IQ24_ONE, IQ24(8.0), IQ24(8.0)};
    iqfoc_observer_inductance_config_t above = most;
    above.high++;
    iqfoc_observer_config_t large = nominal;
    large.machine.l_d = large.machine.l_q = IQ24(8.0);
    large.machine.k_d = large.machine.k_q = IQ24(0.125);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &most, &large));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, iqfoc_observer_inductance_init(&a, &above, &large));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step_is_that_of_its_lines);
    RUN_TEST(test_error_of_inductance_decays);
    RUN_TEST(test_holds_without_steps_of_the_current);
    RUN_TEST(test_holds_below_a_speed);
    RUN_TEST(test_least_voltage);
    RUN_TEST(test_holds_while_the_observer_seeks);
    RUN_TEST(test_stays_within_its_bounds);
    RUN_TEST(test_refuses_what_is_out_of_range);
    return UNITY_END();
}

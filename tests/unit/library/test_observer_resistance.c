/*
 * R and psi_f of the observer from its radial error (include/iqfoc/observer_resistance.h): each sentence of the header but those of a
 * drive, which test_sensorless.c has.
 */
#include "iqfoc/observer_resistance.h"
#include "reference_vectors.h"

#include "unity.h"

#include <stddef.h>
#include <stdio.h>

#define LSB (1.0 / 16777216.0)

static const iqfoc_observer_config_t nominal =
    IQFOC_OBSERVER_CONFIG(0.5, 1.5e-3, 1.5e-3, 0.03, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.002));

static iqfoc_observer_resistance_config_t config;
static iqfoc_observer_config_t adapted;
static iqfoc_observer_resistance_t a;
static iqfoc_observer_t o;

void setUp(void)
{
    config = (iqfoc_observer_resistance_config_t){IQ24(0.05), IQ24(0.5), IQ24(0.1)};
    adapted = nominal;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_resistance_init(&a, &config, &adapted));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &adapted));
    o.locked = true;
}

void tearDown(void)
{
}

static double held(double x, double most)
{
    return fmax(-most, fmin(most, x));
}

static double complex held_vector(double complex x, double most)
{
    return held(creal(x), most) + I * held(cimag(x), most);
}

static double largest(double complex x)
{
    return fmax(fabs(creal(x)), fabs(cimag(x)));
}

/* One line of the header each. */
typedef struct expected {
    double complex driven, s, flux;
    double x, y, off, r, psi;
    int seen; /* 1: R, 2: psi_f */
} expected;

static expected expect(iqfoc_ab_t i)
{
    expected e;
    const double complex d = cexp(I * TWO_PI * to_double(iqfoc_observer_theta(&o, 0)));
    const double speed = fabs(to_double(iqfoc_observer_speed(&o)));
    const double psi_f = to_double(a.psi_nominal);
    const double drive = to_double(a.r_nominal) / psi_f;
    e.driven = held_vector(complex_of_ab(a.s) - held_vector(drive * complex_of_ab(i), 32.0), 32.0);
    e.x = -creal(e.driven * conj(d));
    e.y = cimag(e.driven * conj(d));
    e.s = held_vector(e.driven + fmin(to_double(adapted.gain_max), 0.4 * TWO_PI * speed) * e.x * d, 32.0);
    e.off = held(to_double(o.flux_error) / psi_f, 1.0);
    e.r = to_double(a.r);
    e.psi = to_double(a.psi);
    e.flux = complex_of_ab(o.psi);
    e.seen = 0;
    const double least = to_double(config.psi_share) / to_double(config.r_share);
    if (fabs(e.x) >= least && fabs(e.x) >= fabs(e.y)) {
        e.seen = 1;
        e.r = held(e.r - to_double(config.gain) * e.off / e.x, to_double(config.r_share));
        e.flux = held_vector(e.flux + psi_f * e.s * (e.r - to_double(a.r)), 32.0);
    } else if (fmax(fabs(e.x), fabs(e.y)) < 0.5 * least && speed >= to_double(adapted.speed_min)) {
        e.seen = 2;
        e.psi = held(e.psi - to_double(config.gain) * e.off, to_double(config.psi_share));
    }
    return e;
}

static bool near_a_limit(const expected *e, double most)
{
    const double least = to_double(config.psi_share) / to_double(config.r_share);
    const double larger = fmax(fabs(e->x), fabs(e->y));
    return fabs(fabs(e->x) - least) < most || fabs(fabs(e->x) - fabs(e->y)) < most ||
           fabs(larger - 0.5 * least) < most;
}

/* The header's lines in double, from the same state: any state, current and error. */
static void test_step_is_that_of_its_lines(void)
{
    uint64_t seed = 41;
    long seen[3] = {0, 0, 0};
    double over[3] = {0.0, 0.0, 0.0}; /* over the bounds */
    for (int n = 0; n < 400000; n++) {
        adapted = nominal;
        adapted.machine.psi = random_iq24(&seed, 0.05, 12.0);
        adapted.machine.r = random_iq24(&seed, 0.0, 0.2);
        config.gain = random_iq24(&seed, 1e-6, 1.0);
        config.r_share = random_iq24(&seed, 0.0625, 0.5);
        config.psi_share = random_iq24(&seed, 0.015625, 0.25);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_resistance_init(&a, &config, &adapted));
        const double reach = n % 3 == 0 ? 31.0 : (n % 3 == 1 ? 0.5 : 0.02);
        a.s = random_ab_in_square(&seed, reach);
        a.r = random_iq24(&seed, -1.0, 1.0) / (IQ24_ONE / config.r_share + 1);
        a.psi = random_iq24(&seed, -1.0, 1.0) / (IQ24_ONE / config.psi_share + 1);
        o.psi = random_ab_in_square(&seed, n % 2 == 0 ? 31.0 : 1.0);
        o.theta_q32 = (int32_t)random_iq24(&seed, -127.0, 127.0);
        o.speed_q32 = (int32_t)random_iq24(&seed, -85.0, 85.0);
        o.flux_error = random_iq24(&seed, -8.0, 8.0) / (n % 4 == 0 ? 1 : 500);
        const iqfoc_ab_t i = random_ab_in_square(&seed, n % 5 == 0 ? 15.9 : 1.0);
        const double before = to_double(a.r);
        const expected e = expect(i);
        iqfoc_observer_resistance_step(&a, &o, i);
        const double s_bound = 2.0 + 3.0 * largest(e.driven) + largest(complex_of_ab(i));
        over[0] = fmax(over[0], largest(complex_of_ab(a.s) - e.s) / LSB / s_bound);
        if (near_a_limit(&e, 200.0 * LSB)) {
            continue;
        }
        seen[e.seen]++;
        const double gain = to_double(config.gain);
        const double psi_f = to_double(a.psi_nominal);
        const double x_bound = (3.0 + 3.0 * fabs(e.x) + largest(complex_of_ab(i))) * fabs(e.off / e.x);
        const double r_bound = e.seen == 1 ? 1.0 + gain * (1.0 + psi_f + x_bound) / fabs(e.x) : 0.0;
        const double psi_bound = e.seen == 2 ? 1.0 + gain * (1.0 + psi_f) : 0.0;
        const double r_off = fabs(to_double(a.r) - e.r) / LSB;
        const double psi_off = fabs(to_double(a.psi) - e.psi) / LSB;
        TEST_ASSERT_TRUE(r_off <= r_bound && psi_off <= psi_bound);
        over[1] = fmax(over[1], e.seen == 1 ? r_off / r_bound : 0.0);
        over[2] = fmax(over[2], e.seen == 2 ? psi_off / psi_bound : 0.0);
        const double change = to_double(a.r) - before;
        TEST_ASSERT_DOUBLE_WITHIN(
            (2.0 + 2.0 * psi_f * s_bound + 2.0 * largest(e.s)) * LSB, 0.0,
            e.seen != 1 || largest(e.flux) >= 31.99
                ? 0.0
                : largest(complex_of_ab(o.psi) - e.flux + psi_f * e.s * (e.r - before - change)));
        const double r = to_double(a.r_nominal) * (e.seen == 1 ? 1.0 + to_double(a.r) : 1.0);
        const double psi = psi_f * (e.seen == 2 ? 1.0 + to_double(a.psi) : 1.0);
        TEST_ASSERT_DOUBLE_WITHIN(LSB, r, to_double(adapted.machine.r));
        TEST_ASSERT_DOUBLE_WITHIN(LSB, psi, to_double(adapted.machine.psi));
    }
    printf("  seed 41: R seen %ld, psi_f seen %ld, neither %ld; s, r, psi at most %.2f, %.2f, %.2f of the "
           "bounds\n",
           seen[1], seen[2], seen[0], over[0], over[1], over[2]);
    TEST_ASSERT_TRUE(seen[0] > 50000 && seen[1] > 50000 && seen[2] > 10000);
    TEST_ASSERT_TRUE(over[0] <= 1.0);
}

/* The observer and this header in a machine in double with ideal sensors: i_q constant at a constant speed. */
static void turn(double r, double psi_f, double i_q, double speed, int cycles)
{
    const double l = to_double(nominal.machine.l_q);
    double theta = 0.0;
    iqfoc_observer_start(&o, (iqfoc_ab_t){0, to_iq24(i_q)}, 0, to_iq24(speed), true);
    for (int k = 0; k < cycles; k++) {
        const double complex before = cexp(I * TWO_PI * theta);
        theta += speed;
        const double complex after = cexp(I * TWO_PI * theta);
        const double complex mean = i_q * (after - before) / (TWO_PI * speed);
        const double complex u = (psi_f + I * l * i_q) * (after - before) + r * mean;
        const double complex i = I * i_q * after;
        iqfoc_observer_step(&o, (iqfoc_ab_t){to_iq24(creal(u)), to_iq24(cimag(u))},
                            (iqfoc_ab_t){to_iq24(creal(mean)), to_iq24(cimag(mean))},
                            (iqfoc_ab_t){to_iq24(creal(i)), to_iq24(cimag(i))});
        iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){to_iq24(creal(i)), to_iq24(cimag(i))});
        TEST_ASSERT_TRUE(o.locked);
        o.status = 0;
    }
}

/* R where it is seen, either sense of rotation and current; |dr| at most |dp| r_share/psi_share. */
static void test_resistance_at_low_speed(void)
{
    const double r = to_double(nominal.machine.r);
    const double psi = to_double(nominal.machine.psi);
    for (int k = 0; k < 16; k++) {
        setUp();
        const double true_r = r * ((k & 1) != 0 ? 1.4 : 0.6);
        const double true_psi = psi * ((k & 2) != 0 ? 1.0 : 0.98);
        const double i_q = (k & 4) != 0 ? 0.8 : -0.8;
        const double speed = ((k & 8) != 0 ? 1.0 : -1.0) * r * 0.8 / psi / TWO_PI / 0.3;
        turn(true_r, true_psi, i_q, speed, 3000);
        TEST_ASSERT_DOUBLE_WITHIN(((k & 2) != 0 ? 0.01 : 0.075) * r, true_r, to_double(adapted.machine.r));
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * psi, psi, to_double(adapted.machine.psi));
    }
}

/* psi_f where it is seen: off by R's share over x then. R keeps its value. */
static void test_flux_at_high_speed(void)
{
    const double r = to_double(nominal.machine.r);
    const double psi = to_double(nominal.machine.psi);
    for (int k = 0; k < 4; k++) {
        setUp();
        const double true_r = r * ((k & 1) != 0 ? 1.0 : 1.5);
        const double true_psi = psi * ((k & 2) != 0 ? 1.08 : 0.92);
        turn(true_r, true_psi, 0.5, 0.1, 2000);
        const double from_r = (true_r - r) * 0.5 / (TWO_PI * 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * psi, true_psi + from_r, to_double(adapted.machine.psi));
        TEST_ASSERT_EQUAL_INT32(nominal.machine.r, adapted.machine.r);
    }
}

static void test_keeps_both_in_between_and_at_rest(void)
{
    const double r = to_double(nominal.machine.r);
    const double psi = to_double(nominal.machine.psi);
    config.gain = IQ24(0.01); /* so slow that the time until s has grown does not count */
    turn(1.3 * r, 1.05 * psi, 0.5, r * 0.5 / psi / TWO_PI / 0.13, 2000);
    TEST_ASSERT_EQUAL_INT32(nominal.machine.r, adapted.machine.r);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * psi, psi, to_double(adapted.machine.psi));
    setUp();
    o.flux_error = nominal.machine.psi / 8;
    for (int k = 0; k < 100; k++) {
        iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){0, 0}); /* no current, below speed_min */
    }
    TEST_ASSERT_EQUAL_INT32(nominal.machine.r, adapted.machine.r);
    TEST_ASSERT_EQUAL_INT32(nominal.machine.psi, adapted.machine.psi);
}

static void test_keeps_both_while_the_observer_seeks(void)
{
    a.s = (iqfoc_ab_t){IQ24(-1.0), 0};
    o.flux_error = nominal.machine.psi / 8;
    o.locked = false;
    iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){IQ24_ONE, 0});
    TEST_ASSERT_EQUAL_INT32(nominal.machine.r, adapted.machine.r);
    TEST_ASSERT_EQUAL_INT32(nominal.machine.psi, adapted.machine.psi);
    TEST_ASSERT_EQUAL_INT32(0, a.s.alpha);
}

static void test_stays_within_its_bounds(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        for (int k = 0; k < 2000; k++) {
            a.s = (iqfoc_ab_t){IQ24(-1.0), 0};
            o.flux_error = sign * nominal.machine.psi;
            iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){0, 0});
        }
        TEST_ASSERT_EQUAL_INT32(-sign * config.r_share, a.r);
        o.speed_q32 = INT32_C(1) << 28;
        a.s = (iqfoc_ab_t){0, 0};
        for (int k = 0; k < 2000; k++) {
            iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){0, 0});
        }
        TEST_ASSERT_EQUAL_INT32(-sign * config.psi_share, a.psi);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_check(&adapted));
    }
}

static iqfoc_error_t init_with(iq24_t gain, iq24_t r_share, iq24_t psi_share)
{
    const iqfoc_observer_resistance_config_t c = {gain, r_share, psi_share};
    return iqfoc_observer_resistance_init(&a, &c, &adapted);
}

static void test_refuses_what_is_out_of_range(void)
{
    const iq24_t r = IQ24(0.5);
    const iq24_t psi = IQ24(0.1);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_resistance_init(NULL, &config, &adapted));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_resistance_init(&a, NULL, &adapted));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_observer_resistance_init(&a, &config, NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_with(1, IQ24(0.0625), IQ24(0.015625)));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_with(IQ24_ONE, IQ24(0.5), IQ24(0.25)));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(0, r, psi));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(IQ24_ONE + 1, r, psi));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, IQ24(0.0625) - 1, psi));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, r + 1, psi));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, r, IQ24(0.015625) - 1));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, r, IQ24(0.25) + 1));
    adapted.machine.psi = IQ24(0.015625); /* too small once lowered */
    adapted.machine.r = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, r, psi));
    adapted.machine.psi = IQ24(0.0625);
    adapted.machine.r = IQ24(0.5); /* 8 times, and above */
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, init_with(1, r, psi));
    adapted.machine.r += 16;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_OBSERVER, init_with(1, r, psi));
    adapted = nominal;
    adapted.machine.r = IQ24(IQFOC_MAX_FLUX_R); /* too large once raised */
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_RESISTANCE, init_with(1, r, psi));
    adapted.machine.r = -1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_RESISTANCE, init_with(1, r, psi));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step_is_that_of_its_lines);
    RUN_TEST(test_resistance_at_low_speed);
    RUN_TEST(test_flux_at_high_speed);
    RUN_TEST(test_keeps_both_in_between_and_at_rest);
    RUN_TEST(test_keeps_both_while_the_observer_seeks);
    RUN_TEST(test_stays_within_its_bounds);
    RUN_TEST(test_refuses_what_is_out_of_range);
    return UNITY_END();
}

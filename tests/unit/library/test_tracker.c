/*
 * Tracker: one step against the formulas in double, its poles, its error at a constant acceleration, and when a
 * sensor is lost.
 */
#include "iqfoc/tracker.h"
#include "reference.h"

#include <stddef.h>

#define SEED  UINT64_C(4242)
#define DRAWS 400000
#define T_S   2e-4

static const iqfoc_tracker_config_t usual = IQFOC_TRACKER_GAINS(300.0, T_S, IQ24(0.1), 20);
static const double unit = 4294967296.0; /* of Q32 */

void setUp(void)
{
}

void tearDown(void)
{
}

static double round_trip(double turns)
{
    return remainder(turns, 1.0);
}

static void test_step_follows_its_law(void)
{
    uint64_t seed = SEED;
    double theta_off = 0.0;
    double turns_off = 0.0;
    double acceleration_off = 0.0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_tracker_config_t config = {1 + random_iq24(&seed, 0.0, 0.9),
                                               1 + random_iq24(&seed, 0.0, 0.9), random_iq24(&seed, 0.0, 1.0),
                                               IQ24(0.5), 5};
        iqfoc_tracker_t t = {&config,
                             (int32_t)(unit * uniform(&seed, -0.5, 0.5)),
                             (int32_t)(unit * uniform(&seed, -0.3, 0.3)),
                             (int32_t)(unit * uniform(&seed, -0.02, 0.02)),
                             0,
                             0,
                             2,
                             false};
        const iq24_t at = random_iq24(&seed, -1.0, 1.0);
        const iq24_t measured = random_iq24(&seed, -100.0, 100.0);
        const double acceleration = t.acceleration_q32 / unit;
        const double theta = t.theta_q32 / unit + t.speed_q32 / unit + acceleration / 2.0;
        const double speed = t.speed_q32 / unit + acceleration;
        const double e = round_trip(to_double(measured) - theta - speed * to_double(at));
        const double speed_want = speed + to_double(config.k2) * e;
        if (fabs(fabs(e) - 0.5) < 1e-7 || fabs(speed_want) > 0.333) {
            continue; /* a tie, and the limit of the speed */
        }
        iqfoc_tracker_step(&t, measured, at, true);
        const double theta_want = theta + to_double(config.k1) * e;
        const double held = fmax(-0.125, fmin(0.125, acceleration + to_double(config.k3) * e));
        theta_off = fmax(theta_off, fabs(round_trip(t.theta_q32 / unit - theta_want)) * unit);
        turns_off = fmax(turns_off, fabs(t.speed_q32 / unit - speed_want) * unit);
        acceleration_off = fmax(acceleration_off, fabs(t.acceleration_q32 / unit - held) * unit);
        TEST_ASSERT_TRUE(fabs(to_double(t.error) - e) <= 1.1 / 16777216.0);
    }
    printf("  units of 2^-32: theta %.2f, turns %.2f, acceleration %.2f\n", theta_off, turns_off,
           acceleration_off);
    TEST_ASSERT_TRUE(theta_off <= 2.0 && theta_off >= 1.0);
    TEST_ASSERT_TRUE(turns_off <= 2.0 && turns_off >= 1.0);
    TEST_ASSERT_TRUE(acceleration_off <= 2.0 && acceleration_off >= 1.0);
}

/* Three poles at p: the error of a step of the angle is a polynomial of second degree in k times p^k. */
static void test_poles(void)
{
    const double p = IQFOC_RAW_TRACKER_POLE(300.0, T_S);
    for (int32_t kind = 2; kind <= 3; kind++) {
        const iqfoc_tracker_config_t two = IQFOC_TRACKER_GAINS_2(300.0, T_S, IQ24(0.1), 20);
        const iqfoc_tracker_config_t *config = kind == 2 ? &two : &usual;
        double e[400];
        iqfoc_tracker_t t;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, config));
        iqfoc_tracker_step(&t, 0, 0, true);
        iqfoc_tracker_step(&t, 0, 0, true);
        for (int32_t k = 0; k < 400; k++) {
            iqfoc_tracker_step(&t, IQ24(0.05), 0, true);
            e[k] = (0.05 - t.theta_q32 / unit) / pow(p, k);
        }
        /* The third (second) difference of such a polynomial is 0. */
        for (int32_t k = 3; k < 60; k++) {
            const double d = kind == 3 ? e[k] - 3.0 * e[k - 1] + 3.0 * e[k - 2] - e[k - 3]
                                       : e[k] - 2.0 * e[k - 1] + e[k - 2];
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.0, d);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.05, t.theta_q32 / unit);
    }
}

/* A run-up: nothing is left of a steady acceleration, but a/k2 where k3 is 0. In both directions, over wraps. */
static void test_acceleration(void)
{
    const iqfoc_tracker_config_t two = IQFOC_TRACKER_GAINS_2(300.0, T_S, IQ24(0.1), 20);
    for (int32_t way = -1; way <= 1; way += 2) {
        const double a = way * 1e-4;
        iqfoc_tracker_t third;
        iqfoc_tracker_t second;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&third, &usual));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&second, &two));
        for (int32_t k = 0; k < 3000; k++) {
            const double theta = a * k * k / 2.0;
            const double late = 0.25;
            const double read = theta + a * k * late + a * late * late / 2.0;
            iqfoc_tracker_step(&third, to_iq24(round_trip(read)), to_iq24(late), true);
            iqfoc_tracker_step(&second, to_iq24(round_trip(read)), to_iq24(late), true);
            if (k > 1000) {
                TEST_ASSERT_DOUBLE_WITHIN(1.5e-5, 0.0, round_trip(third.theta_q32 / unit - theta));
                TEST_ASSERT_DOUBLE_WITHIN(2e-5, a * k, to_double(iqfoc_tracker_speed(&third)));
                TEST_ASSERT_DOUBLE_WITHIN(0.05 * fabs(a / to_double(two.k2)), -a / to_double(two.k2),
                                          round_trip(second.theta_q32 / unit - theta) /
                                              (1.0 - to_double(two.k1)));
                /* And at the peak, half a cycle on. */
                const double mid = theta + a * k / 2.0;
                TEST_ASSERT_DOUBLE_WITHIN(
                    5e-5, 0.0, round_trip(to_double(iqfoc_tracker_theta(&third, IQ24(0.5))) - mid));
            }
        }
    }
}

static void test_held_at_the_ends(void)
{
    const iqfoc_tracker_config_t hard = {IQ24_ONE, IQ24_ONE, IQ24_ONE, IQ24(0.5), UINT32_MAX};
    uint64_t seed = SEED + 2;
    iqfoc_tracker_t t;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &hard));
    int32_t at_end = 0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iq24_t any = iq24_wrap((int64_t)random_bits(&seed));
        iqfoc_tracker_step(&t, any, n % 3 == 0 ? IQ24_ONE : -IQ24_ONE, true);
        const iq24_t speed = iqfoc_tracker_speed(&t);
        TEST_ASSERT_TRUE(speed >= -IQFOC_ROTOR_SPEED_MAX && speed <= IQFOC_ROTOR_SPEED_MAX);
        TEST_ASSERT_TRUE(t.acceleration_q32 >= -(1 << 29) && t.acceleration_q32 <= 1 << 29);
        const iq24_t far = iqfoc_tracker_theta(&t, n % 2 == 0 ? IQ24(8.0) : IQ24(-8.0));
        TEST_ASSERT_TRUE(far >= -IQ24_ONE / 2 && far < IQ24_ONE / 2);
        const double want = t.theta_q32 / unit + (n % 2 == 0 ? 8.0 : -8.0) * (t.speed_q32 / unit);
        TEST_ASSERT_TRUE(fabs(round_trip(to_double(far) - want)) * 16777216.0 <= 1.01);
        at_end += speed == IQFOC_ROTOR_SPEED_MAX || speed == -IQFOC_ROTOR_SPEED_MAX;
    }
    TEST_ASSERT_TRUE(at_end > 1000);
}

/* Taken up in flight: two measurements are enough, at any speed; a gap between them restarts. */
static void test_acquisition(void)
{
    for (int32_t k = -33; k <= 33; k++) {
        const double speed = k / 100.0;
        iqfoc_tracker_t t;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &usual));
        iqfoc_tracker_step(&t, to_iq24(0.9), 0, true);
        iqfoc_tracker_step(&t, to_iq24(0.1), 0, false);
        iqfoc_tracker_step(&t, to_iq24(0.4), to_iq24(0.2), true);
        iqfoc_tracker_step(&t, to_iq24(0.4 + speed), to_iq24(0.2), true);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, speed, t.speed_q32 / unit);
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, 0.0, round_trip(t.theta_q32 / unit - (0.4 + speed - 0.2 * speed)));
        for (int32_t n = 2; n < 40; n++) {
            iqfoc_tracker_step(&t, to_iq24(round_trip(0.4 + speed * n)), to_iq24(0.2), true);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, to_double(t.error));
        }
    }
}

static void test_lost(void)
{
    iqfoc_tracker_t t;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &usual));
    for (int32_t k = 0; k < 50; k++) {
        iqfoc_tracker_step(&t, to_iq24(0.01 * k), 0, true);
    }
    /* Nothing measured, or far off: it runs on with its speed, and is not pulled along. */
    for (int32_t k = 50; k < 70; k++) {
        const bool none = k % 2 == 0;
        iqfoc_tracker_step(&t, to_iq24(0.01 * k + (none ? 0.0 : 0.11)), 0, !none);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, round_trip(t.theta_q32 / unit - 0.01 * k));
        TEST_ASSERT_FALSE(t.lost);
    }
    iqfoc_tracker_t more = t;
    iqfoc_tracker_step(&t, to_iq24(0.7), 0, true); /* one good one */
    TEST_ASSERT_EQUAL_UINT32(0, t.missing);
    iqfoc_tracker_step(&more, 0, 0, false); /* the twenty-first in a row */
    TEST_ASSERT_TRUE(more.lost);
    for (int32_t k = 71; k < 100; k++) {
        iqfoc_tracker_step(&more, to_iq24(0.01 * k), 0, true);
        TEST_ASSERT_TRUE(more.lost); /* sticky */
    }
    iqfoc_tracker_restart(&more);
    TEST_ASSERT_FALSE(more.lost);
    TEST_ASSERT_TRUE(more.config == &usual && more.seen == 0);
    more.missing = UINT32_MAX;
    iqfoc_tracker_step(&more, 0, 0, false);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, more.missing);
}

static void refused(iq24_t k1, iq24_t k2, iq24_t k3, iq24_t far_max, iqfoc_error_t want)
{
    const iqfoc_tracker_config_t config = {k1, k2, k3, far_max, 0};
    iqfoc_tracker_t t = {.seen = 55};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_tracker_init(&t, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 55, t.seen);
}

static void test_limits(void)
{
    iqfoc_tracker_t t;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_tracker_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_tracker_init(&t, NULL));
    refused(1, 1, 0, 1, IQFOC_OK);
    refused(IQ24_ONE, IQ24_ONE, IQ24_ONE, IQ24(0.5), IQFOC_OK);
    refused(0, 1, 0, 1, IQFOC_ERROR_TRACKER);
    refused(IQ24_ONE + 1, 1, 0, 1, IQFOC_ERROR_TRACKER);
    refused(1, 0, 0, 1, IQFOC_ERROR_TRACKER);
    refused(1, IQ24_ONE + 1, 0, 1, IQFOC_ERROR_TRACKER);
    refused(1, 1, -1, 1, IQFOC_ERROR_TRACKER);
    refused(1, 1, IQ24_ONE + 1, 1, IQFOC_ERROR_TRACKER);
    refused(1, 1, 0, 0, IQFOC_ERROR_TRACKER);
    refused(1, 1, 0, IQ24(0.5) + 1, IQFOC_ERROR_TRACKER);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_step_follows_its_law);
    RUN_TEST(test_poles);
    RUN_TEST(test_acceleration);
    RUN_TEST(test_held_at_the_ends);
    RUN_TEST(test_acquisition);
    RUN_TEST(test_lost);
    RUN_TEST(test_limits);
    return UNITY_END();
}

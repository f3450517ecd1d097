/*
 * Tracker, start and speed control to the last bit: any allowed input, one hash for each over all results. test_tracker.c, test_start.c
 * and test_speed_control.c check them in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/speed_control.h"
#include "iqfoc/start.h"
#include "iqfoc/tracker.h"

#include <stdbool.h>

#define RUNS 600

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Tracker ---- */

static iqfoc_tracker_config_t any_tracker(uint64_t *seed, int run)
{
    iqfoc_tracker_config_t c;
    c.k1 = bits_random(seed, 1, IQ24_ONE);
    c.k2 = bits_random(seed, 1, run % 2 == 0 ? IQ24_ONE : IQ24_ONE / 16);
    c.k3 = run % 3 == 0 ? 0 : bits_random(seed, 0, IQ24_ONE / (run % 3 == 1 ? 1 : 64));
    c.far_max = bits_random(seed, 1, IQ24_ONE / 2);
    c.lost_max = (uint32_t)bits_random(seed, 0, 4);
    return c;
}

static void test_tracker(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < RUNS; run++) {
        const iqfoc_tracker_config_t c = any_tracker(&seed, run);
        iqfoc_tracker_t t;
        int64_t angle = 0;
        const int32_t speed = bits_random(&seed, -IQ24_ONE / 2, IQ24_ONE / 2) / (run % 4 == 0 ? 1 : 30);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &c));
        for (int n = 0; n < 200; n++) {
            angle += speed;
            const iq24_t theta = run % 5 == 0 ? bits_random(&seed, INT32_MIN, INT32_MAX)
                                              : iq24_wrap(angle + bits_random(&seed, -4000, 4000));
            const iq24_t at = bits_random(&seed, -IQ24_ONE, IQ24_ONE);
            iqfoc_tracker_step(&t, theta, at, bits_random(&seed, 0, 9) > 0);
            digest_add(&digest, t.theta_q32);
            digest_add(&digest, t.speed_q32);
            digest_add(&digest, t.acceleration_q32);
            digest_add(&digest, t.error);
            digest_add(&digest, (int32_t)t.missing);
            digest_add(&digest, t.lost);
        }
        iqfoc_tracker_restart(&t);
        TEST_ASSERT_EQUAL_PTR(&c, t.config);
        TEST_ASSERT_EQUAL_INT64(0, t.theta_q32 | t.speed_q32 | t.acceleration_q32);
        TEST_ASSERT_EQUAL_INT32(0, t.error);
        TEST_ASSERT_EQUAL_UINT32(0, t.missing | t.seen);
        TEST_ASSERT_FALSE(t.lost);
    }
    bits_golden(UINT64_C(0x5bbe4fdbb2e829fe), digest);
}

/* Missing measurements are counted to the end of the count, and "any number" never is too many. */
static void test_trackers_count_ends(void)
{
    const iqfoc_tracker_config_t c = {1, 1, 0, 1, UINT32_MAX};
    iqfoc_tracker_t t;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &c));
    t.missing = UINT32_MAX - 1;
    for (int n = 0; n < 3; n++) {
        iqfoc_tracker_step(&t, 0, 0, false);
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, t.missing);
        TEST_ASSERT_FALSE(t.lost);
    }
}

/* ---- Start ---- */

static iqfoc_start_config_t any_start(uint64_t *seed, int run)
{
    iqfoc_start_config_t c;
    c.i_align = bits_random(seed, 1, 16 * IQ24_ONE);
    c.ramp_cycles = (uint32_t)bits_random(seed, 1, 40);
    c.hold_cycles = (uint32_t)bits_random(seed, 1, 20);
    c.speed_end = run % 3 == 0 ? 0 : bits_random(seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    c.run_up_cycles = (uint32_t)bits_random(seed, 1, 40);
    return c;
}

static void test_start(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < RUNS; run++) {
        const iqfoc_start_config_t c = any_start(&seed, run);
        iqfoc_start_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &c));
        const uint32_t aligned = 2 * (c.ramp_cycles + c.hold_cycles);
        for (uint32_t n = 1; n < aligned + c.run_up_cycles + 20; n++) {
            iqfoc_start_step(&s, bits_random(&seed, INT32_MIN, INT32_MAX));
            bits_add(&digest, &s.i_ref, sizeof s.i_ref);
            digest_add(&digest, s.theta);
            digest_add(&digest, s.speed);
            digest_add(&digest, s.sensor_before);
            digest_add(&digest, s.sensor_zero);
            digest_add(&digest, (int32_t)s.stage);
            TEST_ASSERT_EQUAL(n < aligned, s.verdict == IQFOC_START_NOT_YET);
        }
        const iqfoc_dq_t seen = iqfoc_start_handover(&s, bits_random(&seed, INT32_MIN, INT32_MAX));
        bits_add(&digest, &seen, sizeof seen);
    }
    bits_golden(UINT64_C(0x501374dddb2ed2eb), digest);
}

/* The verdict by the way between both alignments, to the last number of each range. */
static void test_starts_verdicts(void)
{
    static const iqfoc_start_config_t c = {IQ24_ONE, 1, 1, 0, 0};
    const int64_t quarter = IQ24_ONE / 4;
    const int64_t tolerance = IQ24_ONE / 16;
    const int64_t middle[3] = {-quarter, 0, quarter};
    static const iqfoc_start_verdict_t verdict[3] = {IQFOC_START_GOOD, IQFOC_START_STUCK,
                                                     IQFOC_START_REVERSED};
    for (int k = 0; k < 3; k++) {
        for (int off = -2; off <= 2; off++) {
            const int64_t way = middle[k] +
                                (off < 0   ? -tolerance
                                 : off > 0 ? tolerance
                                           : 0) +
                                (off == -2  ? -1
                                 : off == 2 ? 1
                                            : 0);
            for (int64_t turns = -3; turns <= 3; turns++) {
                const iq24_t before = IQ24(0.4);
                iqfoc_start_t s;
                TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &c));
                for (int n = 0; n < 4; n++) {
                    iqfoc_start_step(&s, n < 2 ? before : iq24_wrap(before + way + turns * IQ24_ONE));
                }
                const bool within = off >= -1 && off <= 1;
                TEST_ASSERT_EQUAL_INT(within ? verdict[k] : IQFOC_START_WRONG_WAY, s.verdict);
            }
        }
    }
}

/* ---- Speed control ---- */

static iqfoc_speed_control_config_t any_speed_control(uint64_t *seed, int run)
{
    iqfoc_speed_control_config_t c;
    c.kp_q16 = bits_random(seed, 1, INT32_MAX >> bits_random(seed, 0, 24));
    c.share = run % 5 == 0 ? IQ24_ONE : bits_random(seed, 0, IQ24_ONE);
    c.ramp_q32 = bits_random(seed, 1, 1 << bits_random(seed, 8, 30));
    c.i_max = bits_random(seed, 1, 4 * IQ24_ONE);
    c.i_ramp = bits_random(seed, 0, c.i_max);
    c.cycles = (uint32_t)bits_random(seed, 1, 3);
    return c;
}

/* A speed, now and then one of those at which a limit begins. */
static iq24_t any_speed(uint64_t *seed)
{
    const iq24_t ends[] = {INT32_MIN, INT32_MAX, IQFOC_ROTOR_SPEED_MAX, -IQFOC_ROTOR_SPEED_MAX, 0};
    return bits_random(seed, 0, 9) == 0 ? ends[bits_random(seed, 0, 4)]
                                        : bits_random(seed, -6000000, 6000000);
}

static void test_speed_control(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < 4 * RUNS; run++) {
        const iqfoc_speed_control_config_t c = any_speed_control(&seed, run);
        iqfoc_speed_control_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&s, &c));
        iq24_t target = 0;
        iq24_t speed = 0;
        iq24_t limit = c.i_max;
        for (int n = 0; n < 60; n++) {
            if (n % 20 == 0) {
                speed = any_speed(&seed);
                iqfoc_speed_control_start(&s, speed, bits_random(&seed, -5 * IQ24_ONE, 5 * IQ24_ONE));
                target = any_speed(&seed);
            }
            if (n % 5 == 0) {
                limit = bits_random(&seed, 0, 3) == 0 ? bits_random(&seed, INT32_MIN, INT32_MAX) : c.i_max;
            }
            speed = bits_random(&seed, 0, 9) == 0
                        ? any_speed(&seed)
                        : (iq24_t)bits_held(speed, -IQ24_ONE, IQ24_ONE) + bits_random(&seed, -2000, 2000);
            digest_add(&digest, iqfoc_speed_control_step(&s, target, speed, limit));
            bits_add64(&digest, s.integral);
            digest_add(&digest, s.set_point_q32);
            digest_add(&digest, (int32_t)s.wait);
        }
    }
    bits_golden(UINT64_C(0xb57668ed33b456e9), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tracker);
    RUN_TEST(test_trackers_count_ends);
    RUN_TEST(test_start);
    RUN_TEST(test_starts_verdicts);
    RUN_TEST(test_speed_control);
    return UNITY_END();
}

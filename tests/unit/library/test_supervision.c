/*
 * Supervision: a lost phase at every speed and angle and no false one, the sum of three currents, the extremes.
 */
#include "iqfoc/cycle.h"
#include "iqfoc/supervision.h"
#include "reference.h"

#include <stddef.h>

static const iqfoc_supervision_config_t usual = {IQ24(0.1), IQ24(0.125), 12, 3, IQ24(0.2), 5};

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_abc_t currents(double size, double turns, int32_t lost)
{
    double i[3];
    for (int32_t x = 0; x < 3; x++) {
        i[x] = size * cos(TWO_PI * (turns - x / 3.0));
    }
    if (lost >= 0) {
        /* The two others carry the same current, one there and one back. */
        i[(lost + 1) % 3] = size * sin(TWO_PI * turns);
        i[(lost + 2) % 3] = -i[(lost + 1) % 3];
        i[lost] = 0.0;
    }
    const iqfoc_abc_t abc = {to_iq24(i[0]), to_iq24(i[1]), to_iq24(i[2])};
    return abc;
}

/* Cycles until the bit is set, or `most`. */
static int32_t run(iqfoc_supervision_t *s, double size, double speed, double start, int32_t lost,
                   int32_t most)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(s, &usual));
    for (int32_t k = 0; k < most; k++) {
        const uint32_t status =
            iqfoc_supervision_step(s, currents(size, start + speed * k, lost), to_iq24(speed), true);
        TEST_ASSERT_EQUAL_UINT32(status, s->status);
        if (status != 0) {
            return k;
        }
    }
    return most;
}

static void test_lost_phase_at_every_speed(void)
{
    uint64_t seed = UINT64_C(9);
    for (int32_t n = 0; n < 3000; n++) {
        const double speed = (n % 2 == 0 ? 1.0 : -1.0) * pow(10.0, uniform(&seed, -3.0, log10(1.0 / 3.0)));
        const int32_t most = 2 * (int32_t)(3.0 * (13.0 + 0.5 / fabs(speed)));
        iqfoc_supervision_t s;
        const double start = uniform(&seed, 0.0, 1.0);
        TEST_ASSERT_EQUAL_INT32(most, run(&s, uniform(&seed, 0.16, 15.0), speed, start, -1, most));
        const int32_t lost = n % 3;
        const int32_t found = run(&s, uniform(&seed, 0.3, 15.0), speed, start, lost, most);
        /* The currents of a star of two vanish together at some angles: not where samples meet just those. */
        if (fabs(remainder(2.0 * speed, 1.0)) > 0.02 || fabs(speed) < 0.1) {
            TEST_ASSERT_TRUE(found < most);
            TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LOST_PHASE, s.status);
            TEST_ASSERT_EQUAL_UINT32(UINT32_C(1) << lost, s.phase);
            TEST_ASSERT_TRUE(found + 1 >= 36); /* three windows of twelve */
        }
    }
}

/* Little current, standstill and gates off say nothing. */
static void test_nothing_is_said_without_ground(void)
{
    iqfoc_supervision_t s;
    TEST_ASSERT_EQUAL_INT32(5000, run(&s, 0.05, 0.02, 0.0, 1, 5000));
    TEST_ASSERT_EQUAL_INT32(5000, run(&s, 2.0, 0.0, 0.3, 1, 5000));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &usual));
    for (int32_t k = 0; k < 5000; k++) {
        /* On for two windows at a time. */
        const bool on = k % 60 < 55;
        TEST_ASSERT_EQUAL_UINT32(0, iqfoc_supervision_step(&s, currents(1.0, 0.02 * k, 2), IQ24(0.02), on));
    }
    for (int32_t k = 0; k < 5000; k++) {
        /* To and fro: no window is turned through. */
        const double angle = 0.2 * sin(0.01 * k);
        const double next = 0.2 * sin(0.01 * (k + 1));
        TEST_ASSERT_EQUAL_UINT32(
            0, iqfoc_supervision_step(&s, currents(1.0, angle, 2), to_iq24(next - angle), true));
    }
    /* One good window between bad ones. */
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &usual));
    for (int32_t k = 0; k < 5000; k++) {
        const int32_t window = k / 25;
        TEST_ASSERT_EQUAL_UINT32(0,
                                 iqfoc_supervision_step(&s, currents(1.0, 0.02 * k, window % 3 == 2 ? -1 : 0),
                                                        IQ24(0.02) + 1, true));
    }
}

static void test_sum_of_three(void)
{
    iqfoc_supervision_t s;
    for (int32_t way = -1; way <= 1; way += 2) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &usual));
        const iqfoc_abc_t at_limit = {way * IQ24(0.1), way * (IQ24(0.2) - IQ24(0.1)), 0};
        const iqfoc_abc_t beyond = {at_limit.a, at_limit.b + way, 0};
        for (int32_t k = 0; k < 100; k++) {
            TEST_ASSERT_EQUAL_UINT32(0, iqfoc_supervision_step(&s, k % 5 == 4 ? at_limit : beyond, 0, false));
        }
        for (int32_t k = 0; k < 5; k++) {
            const uint32_t status = iqfoc_supervision_step(&s, beyond, 0, k % 2 == 0);
            TEST_ASSERT_EQUAL_UINT32(k == 4 ? IQFOC_STATUS_LOST_CURRENT_SENSOR : 0, status);
        }
        /* Sticky. */
        TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LOST_CURRENT_SENSOR,
                                 iqfoc_supervision_step(&s, at_limit, 0, false));
        iqfoc_supervision_clear(&s);
        TEST_ASSERT_EQUAL_UINT32(0, s.status);
        TEST_ASSERT_TRUE(s.config == &usual);
    }
}

/* The largest numbers for a window of full length, and past it. */
static void test_extremes(void)
{
    const iqfoc_supervision_config_t config = {IQ24(16.0), IQ24(0.5), 1 << 20, 1, IQ24(16.0), 1 << 20};
    const iqfoc_abc_t ends = {IQ24_MIN, IQ24_MAX, IQ24_MIN};
    iqfoc_supervision_t s;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &config));
    for (int32_t k = 0; k < (1 << 24) - 1; k++) {
        (void)iqfoc_supervision_step(&s, ends, 0, true);
    }
    TEST_ASSERT_EQUAL_UINT32((1 << 24) - 1, s.cycles);
    iqfoc_supervision_t more = s;
    (void)iqfoc_supervision_step(&s, ends, 0, true);
    TEST_ASSERT_EQUAL_UINT32(0, s.cycles); /* restarted */
    /* Turned through in its last cycle: judged, and no phase is found missing; a missing one is. */
    iqfoc_supervision_t missing = more;
    missing.sum_b = more.sum_a / 2 - more.sum_a / 1024;
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LOST_CURRENT_SENSOR,
                             iqfoc_supervision_step(&more, ends, IQ24_ONE, true));
    (void)iqfoc_supervision_step(&missing, ends, -IQ24_ONE, true);
    TEST_ASSERT_EQUAL_UINT32(2, missing.phase);
}

/* The bits are different from the cycle's. */
static void test_bits_are_free(void)
{
    const uint32_t own = IQFOC_STATUS_LOST_PHASE | IQFOC_STATUS_LOST_CURRENT_SENSOR |
                         IQFOC_STATUS_LOST_ANGLE_SENSOR | IQFOC_STATUS_BREAK;
    const uint32_t cycles = IQFOC_STATUS_MISSED | IQFOC_STATUS_LATE | IQFOC_STATUS_STALE |
                            IQFOC_STATUS_SAMPLE_CLIPPED | IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_OVERSPEED |
                            IQFOC_STATUS_VOLTAGE_LIMIT | IQFOC_STATUS_DC_LINK | IQFOC_STATUS_NO_INTERVAL;
    TEST_ASSERT_EQUAL_UINT32(0, own & cycles);
    TEST_ASSERT_EQUAL_UINT32(0x000F0000, own);
}

static void refused(iqfoc_supervision_config_t config, iqfoc_error_t want)
{
    iqfoc_supervision_t s = {.cycles = 9};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_supervision_init(&s, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 9, s.cycles);
}

/* A phase is lost below `share` of the largest, not at it. */
static void test_share_itself_is_no_loss(void)
{
    for (int32_t x = 0; x < 3; x++) {
        for (int32_t below = 0; below < 2; below++) {
            iqfoc_supervision_t s;
            iq24_t i[3];
            i[x] = usual.share - below;
            i[(x + 1) % 3] = -IQ24_ONE;
            i[(x + 2) % 3] = IQ24_ONE - i[x];
            const iqfoc_abc_t abc = {i[0], i[1], i[2]};
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &usual));
            for (int32_t k = 0; k < 200; k++) {
                (void)iqfoc_supervision_step(&s, abc, IQ24(0.125), true);
            }
            TEST_ASSERT_EQUAL_UINT32((uint32_t)below << x, s.phase);
        }
    }
}

static void test_limits(void)
{
    iqfoc_supervision_t s;
    const uint32_t most = UINT32_C(1) << 20;
    const iq24_t high = IQ24(16.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_supervision_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_supervision_init(&s, NULL));
    refused((iqfoc_supervision_config_t){1, 1, 6, 1, 1, 1}, IQFOC_OK);
    refused((iqfoc_supervision_config_t){high, IQ24(0.5), most, most, high, most}, IQFOC_OK);
    refused((iqfoc_supervision_config_t){0, 1, 6, 1, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){high + 1, 1, 6, 1, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, IQ24(0.5) + 1, 6, 1, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, 1, 5, 1, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, 1, 6, 0, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, 1, 6, most + 1, 1, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, 1, 6, 1, 0, 1}, IQFOC_ERROR_SUPERVISION);
    refused((iqfoc_supervision_config_t){1, 1, 6, 1, 1, 0}, IQFOC_ERROR_SUPERVISION);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_lost_phase_at_every_speed);
    RUN_TEST(test_nothing_is_said_without_ground);
    RUN_TEST(test_sum_of_three);
    RUN_TEST(test_extremes);
    RUN_TEST(test_bits_are_free);
    RUN_TEST(test_share_itself_is_no_loss);
    RUN_TEST(test_limits);
    return UNITY_END();
}

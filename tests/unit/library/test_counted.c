/* Assumptions of the proofs (docs/proofs.md), checked for every number. */
#include "iqfoc/cycle_guard.h"
#include "iqfoc/iq24_math.h"
#include "iqfoc/watch.h"

#include "unity.h"

#include <inttypes.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/* How many of all 2^32 numbers the guard lets through, if it lets none through that is beyond; else 0. */
static int64_t let_through(iq24_t limit)
{
    int64_t count = 0;
    int64_t wrong = 0;
    for (int64_t x = IQ24_MIN; x <= IQ24_MAX; x++) {
        const bool good = iqfoc_guard_beyond((iq24_t)x, limit) <= INT32_MAX;
        count += good ? 1 : 0;
        wrong += good && (x > limit || x < -(int64_t)limit - 1) ? 1 : 0;
    }
    return wrong == 0 ? count : 0;
}

/* Of the guard's own limit, with -limit - 1, all lie within the rotor's. */
static void test_speed(void)
{
    TEST_ASSERT_EQUAL_INT64(2 * (int64_t)IQFOC_GUARD_SPEED + 2, let_through(IQFOC_GUARD_SPEED));
    TEST_ASSERT_TRUE(IQFOC_GUARD_SPEED < IQFOC_ROTOR_SPEED_MAX);
}

/* All numbers from 0.5 to 1.5, and none else. */
static void test_dc_link(void)
{
    int64_t wrong = 0;
    for (int64_t x = IQ24_MIN; x <= IQ24_MAX; x++) {
        const bool good = iqfoc_guard_dc_link((iq24_t)x) == 0;
        wrong += good != (x >= IQFOC_CYCLE_U_DC_MIN && x <= IQFOC_CYCLE_U_DC_MAX) ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_INT64(0, wrong);
}

/* src/watch.c: the mean of a block's unit vectors is never longer than 1, for each angle that a cycle can turn. */
static void test_share_of_the_watch(void)
{
    for (iq24_t relative = IQ24(0.0044); relative <= 2 * IQFOC_ROTOR_SPEED_MAX; relative++) {
        const iq24_t half = iq24_sincos(iq24_asr32(relative, 1)).sin;
        const iq24_t block = iq24_sincos(iq24_wrap((int64_t)relative * (IQFOC_WATCH_BLOCK_CYCLES / 2))).sin;
        const iq24_t back = iq24_sincos(iq24_asr32(-relative, 1)).sin;
        const iq24_t block_back =
            iq24_sincos(iq24_wrap((int64_t)-relative * (IQFOC_WATCH_BLOCK_CYCLES / 2))).sin;
        if (iq24_abs_sat(iq24_div(block, IQFOC_WATCH_BLOCK_CYCLES * half)) > IQ24_ONE ||
            iq24_abs_sat(iq24_div(block_back, IQFOC_WATCH_BLOCK_CYCLES * back)) > IQ24_ONE) {
            TEST_FAIL_MESSAGE("a share above 1");
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_speed);
    RUN_TEST(test_dc_link);
    RUN_TEST(test_share_of_the_watch);
    return UNITY_END();
}

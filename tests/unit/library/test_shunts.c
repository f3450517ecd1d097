/*
 * Low-side shunts: which are used, the third current, and that a common part of the duties makes room for two shunts
 * without changing a line voltage.
 */
#include "iqfoc/modulation.h"
#include "iqfoc/shunts.h"
#include "reference.h"

#include <stddef.h>

#define SEED  UINT64_C(271828)
#define DRAWS 200000

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_abc_t drawn(uint64_t *seed, double low, double high)
{
    const iqfoc_abc_t x = {random_iq24(seed, low, high), random_iq24(seed, low, high),
                           random_iq24(seed, low, high)};
    return x;
}

static iqfoc_abc_t abc(iq24_t a, iq24_t b, iq24_t c)
{
    const iqfoc_abc_t x = {a, b, c};
    return x;
}

static void same(iqfoc_abc_t want, iqfoc_abc_t got)
{
    TEST_ASSERT_EQUAL_INT32(want.a, got.a);
    TEST_ASSERT_EQUAL_INT32(want.b, got.b);
    TEST_ASSERT_EQUAL_INT32(want.c, got.c);
}

static void test_choice_in_every_case(void)
{
    const iqfoc_shunts_t shunts = {IQ24(0.9)};
    const iqfoc_abc_t i =
        abc(IQ24(1.0), IQ24(-0.75), IQ24(5.0)); /* do not sum to 0, so that each can be recognised */
    const iqfoc_abc_t guess = abc(7, 8, 9);
    const iq24_t in = IQ24(0.9);
    const iq24_t out = in + 1;
    for (uint32_t bits = 0; bits < 8; bits++) {
        const iqfoc_abc_t duties =
            abc((bits & 1) != 0 ? in : out, (bits & 2) != 0 ? in : out, (bits & 4) != 0 ? in : out);
        const iqfoc_shunts_currents_t got = iqfoc_shunts_read(&shunts, i, duties, guess);
        TEST_ASSERT_EQUAL_UINT32(bits, got.usable);
        TEST_ASSERT_EQUAL_UINT32(bits, iqfoc_shunts_usable(&shunts, duties));
        iqfoc_abc_t want = guess;
        want = bits == 7 ? i : want;
        want = bits == 6 ? abc(IQ24(-4.25), i.b, i.c) : want;
        want = bits == 5 ? abc(i.a, IQ24(-6.0), i.c) : want;
        want = bits == 3 ? abc(i.a, i.b, IQ24(-0.25)) : want;
        same(want, got.i);
        TEST_ASSERT_EQUAL_INT(bits == 7 || bits == 6 || bits == 5 || bits == 3, got.measured);
    }
    const iqfoc_abc_t ends = abc(IQ24_MIN, IQ24_MIN, 0);
    same(abc(IQ24_MIN, IQ24_MIN, IQ24_MAX), iqfoc_shunts_read(&shunts, ends, abc(in, in, out), guess).i);
    const iqfoc_abc_t others = abc(0, IQ24_MAX, IQ24_MAX);
    same(abc(IQ24_MIN, IQ24_MAX, IQ24_MAX), iqfoc_shunts_read(&shunts, others, abc(out, in, in), guess).i);
}

static iq24_t middle_of(iqfoc_abc_t x)
{
    const iq24_t low = iq24_min(x.a, iq24_min(x.b, x.c));
    const iq24_t high = iq24_max(x.a, iq24_max(x.b, x.c));
    return (iq24_t)((int64_t)x.a + x.b + x.c - low - high);
}

static uint32_t count(uint32_t bits)
{
    return (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1);
}

static void test_room(void)
{
    uint64_t seed = SEED;
    int32_t moved = 0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_shunts_t shunts = {random_iq24(&seed, 0.25, 1.0)};
        const iqfoc_abc_t duties = drawn(&seed, n % 2 == 0 ? 0.0 : 0.7, 1.0);
        const iqfoc_abc_t got = iqfoc_shunts_make_room(&shunts, duties);
        const iq24_t low = iq24_min(duties.a, iq24_min(duties.b, duties.c));
        const iq24_t shift = duties.a - got.a;
        TEST_ASSERT_TRUE(shift >= 0 && shift <= low);
        TEST_ASSERT_EQUAL_INT32(shift, duties.b - got.b);
        TEST_ASSERT_EQUAL_INT32(shift, duties.c - got.c);
        const bool enough = count(iqfoc_shunts_usable(&shunts, duties)) >= 2;
        TEST_ASSERT_TRUE(!enough || shift == 0);
        /* No further than needed: either the middle one is at the limit, or the lowest is 0. */
        TEST_ASSERT_TRUE(shift == 0 || middle_of(got) == shunts.duty_max || shift == low);
        TEST_ASSERT_EQUAL_INT(middle_of(duties) - low <= shunts.duty_max,
                              count(iqfoc_shunts_usable(&shunts, got)) >= 2);
        moved += shift > 0;
    }
    TEST_ASSERT_TRUE(moved > DRAWS / 10);
}

/* The whole hexagon of a modulator whose span is duty_max: two shunts always, where centred duties lack them. */
static void test_two_shunts_for_every_voltage(void)
{
    const iqfoc_shunts_t shunts = {IQ24(0.88)};
    int32_t lacking = 0;
    for (int32_t angle = 0; angle < IQ24_ONE; angle += IQ24_ONE / 4096) {
        for (int32_t size = 1; size <= 12; size++) {
            const iq24_sincos_t sc = iq24_sincos(angle);
            const iqfoc_ab_t u = {sc.cos / 10 * size, sc.sin / 10 * size};
            const iqfoc_abc_t duties = iqfoc_modulate(u, IQ24_ONE, shunts.duty_max).high;
            lacking += count(iqfoc_shunts_usable(&shunts, duties)) < 2;
            TEST_ASSERT_TRUE(count(iqfoc_shunts_usable(&shunts, iqfoc_shunts_make_room(&shunts, duties))) >=
                             2);
        }
    }
    TEST_ASSERT_TRUE(lacking > 100);
    /* And centred ones have them up to a span of 2 duty_max - 1. */
    for (int32_t angle = 0; angle < IQ24_ONE; angle += IQ24_ONE / 4096) {
        const iq24_sincos_t sc = iq24_sincos(angle);
        const iqfoc_ab_t u = {sc.cos, sc.sin};
        const iqfoc_abc_t duties = iqfoc_modulate(u, IQ24_ONE, 2 * shunts.duty_max - IQ24_ONE).high;
        TEST_ASSERT_TRUE(count(iqfoc_shunts_usable(&shunts, duties)) >= 2);
    }
}

static void test_check(void)
{
    iqfoc_shunts_t shunts = {IQ24(0.25)};
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_shunts_check(NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_shunts_check(&shunts));
    shunts.duty_max = IQ24_ONE;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_shunts_check(&shunts));
    shunts.duty_max = IQ24_ONE + 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SHUNTS, iqfoc_shunts_check(&shunts));
    shunts.duty_max = IQ24(0.25) - 1;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SHUNTS, iqfoc_shunts_check(&shunts));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_choice_in_every_case);
    RUN_TEST(test_room);
    RUN_TEST(test_two_shunts_for_every_voltage);
    RUN_TEST(test_check);
    return UNITY_END();
}

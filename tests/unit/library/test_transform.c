/*
 * Clarke, Park and their inverses against double precision, at the ends of their ranges and at random.
 */
#include "iqfoc/transform.h"
#include "reference.h"

#define DRAWS 400000
#define SEED  UINT64_C(20261121)

void setUp(void)
{
}

void tearDown(void)
{
}

static const double root3 = 1.73205080756887729353;

static void test_clarke_two_phases(void)
{
    uint64_t seed = SEED;
    worst beta = {"clarke2 beta", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        const double reach = n % 2 == 0 ? 32.0 : 1.5;
        const iq24_t a = n < 4 ? (n % 2 == 0 ? IQ24(32.0) : IQ24(-32.0)) : random_iq24(&seed, -reach, reach);
        const iq24_t b = n < 4 ? (n / 2 == 0 ? IQ24(32.0) : IQ24(-32.0)) : random_iq24(&seed, -reach, reach);
        const iqfoc_ab_t ab = iqfoc_clarke2(a, b);
        TEST_ASSERT_EQUAL_INT32(a, ab.alpha);
        worst_add(&beta, ab.beta, (to_double(a) + 2.0 * to_double(b)) / root3);
    }
    worst_check(&beta, 0.7);
}

static void test_clarke_three_phases_drops_what_is_common(void)
{
    uint64_t seed = SEED + 1;
    worst alpha = {"clarke3 alpha", 0.0};
    worst beta = {"clarke3 beta", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_abc_t abc = {random_iq24(&seed, -31.9, 31.9), random_iq24(&seed, -31.9, 31.9),
                           random_iq24(&seed, -31.9, 31.9)};
        if (n < 8) {
            abc.a = (n & 1) != 0 ? IQ24(31.9) : IQ24(-31.9);
            abc.b = (n & 2) != 0 ? IQ24(31.9) : IQ24(-31.9);
            abc.c = (n & 4) != 0 ? IQ24(31.9) : IQ24(-31.9);
        }
        const double a = to_double(abc.a);
        const double b = to_double(abc.b);
        const double c = to_double(abc.c);
        const iqfoc_ab_t ab = iqfoc_clarke3(abc);
        worst_add(&alpha, ab.alpha, (2.0 * a - b - c) / 3.0);
        worst_add(&beta, ab.beta, (b - c) / root3);
    }
    worst_check(&alpha, 0.7);
    worst_check(&beta, 0.7);
    const iqfoc_abc_t common = {IQ24(20.0), IQ24(20.0), IQ24(20.0)};
    const iqfoc_ab_t none = iqfoc_clarke3(common);
    TEST_ASSERT_EQUAL_INT32(0, none.alpha);
    TEST_ASSERT_EQUAL_INT32(0, none.beta);
}

static void test_inverse_clarke_sums_to_zero(void)
{
    uint64_t seed = SEED + 2;
    worst b = {"inverse clarke b", 0.0};
    worst c = {"inverse clarke c", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_ab_t ab = {random_iq24(&seed, -64.0, 64.0), random_iq24(&seed, -64.0, 64.0)};
        if (n < 4) {
            ab.alpha = (n & 1) != 0 ? IQ24(64.0) : IQ24(-64.0);
            ab.beta = (n & 2) != 0 ? IQ24(64.0) : IQ24(-64.0);
        }
        const iqfoc_abc_t abc = iqfoc_clarke_inverse(ab);
        TEST_ASSERT_EQUAL_INT32(ab.alpha, abc.a);
        TEST_ASSERT_EQUAL_INT64(0, (int64_t)abc.a + abc.b + abc.c);
        worst_add(&b, abc.b, -to_double(ab.alpha) / 2.0 + root3 / 2.0 * to_double(ab.beta));
        worst_add(&c, abc.c, -to_double(ab.alpha) / 2.0 - root3 / 2.0 * to_double(ab.beta));
    }
    worst_check(&b, 1.2);
    worst_check(&c, 1.2);
}

static void test_amplitude_invariant_and_sense_of_rotation(void)
{
    /* A balanced set of peak 1 that turns A -> B -> C is a vector of length 1 at the angle of phase A's
     * phase. */
    for (int32_t step = 0; step < 360; step++) {
        const double angle = TWO_PI * step / 360.0;
        const iqfoc_abc_t abc = {to_iq24(cos(angle)), to_iq24(cos(angle - TWO_PI / 3.0)),
                                 to_iq24(cos(angle + TWO_PI / 3.0))};
        const iqfoc_ab_t ab = iqfoc_clarke3(abc);
        TEST_ASSERT_INT32_WITHIN(2, to_iq24(cos(angle)), ab.alpha);
        TEST_ASSERT_INT32_WITHIN(2, to_iq24(sin(angle)), ab.beta);
        const iqfoc_dq_t dq = iqfoc_park(ab, iq24_sincos(to_iq24(step / 360.0)));
        TEST_ASSERT_INT32_WITHIN(8, IQ24_ONE, dq.d);
        TEST_ASSERT_INT32_WITHIN(8, 0, dq.q);
    }
}

static void test_park_and_inverse(void)
{
    uint64_t seed = SEED + 3;
    worst forward = {"park", 0.0};
    worst inverse = {"inverse park", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        const double reach = n % 2 == 0 ? 64.0 : 1.5;
        const iq24_t x = n < 64 ? (n % 2 == 0 ? IQ24(64.0) : IQ24(-64.0)) : random_iq24(&seed, -reach, reach);
        const iq24_t y = n < 64 ? (n % 4 < 2 ? IQ24(64.0) : IQ24(-64.0)) : random_iq24(&seed, -reach, reach);
        const iq24_sincos_t sc = iq24_sincos(n < 64 ? n * (IQ24_ONE / 16) : random_iq24(&seed, -1.0, 1.0));
        const double s = to_double(sc.sin);
        const double c = to_double(sc.cos);
        const iqfoc_ab_t ab = {x, y};
        const iqfoc_dq_t dq = {x, y};
        const iqfoc_dq_t to_rotor = iqfoc_park(ab, sc);
        const iqfoc_ab_t to_stator = iqfoc_park_inverse(dq, sc);
        worst_add(&forward, to_rotor.d, c * to_double(x) + s * to_double(y));
        worst_add(&forward, to_rotor.q, c * to_double(y) - s * to_double(x));
        worst_add(&inverse, to_stator.alpha, c * to_double(x) - s * to_double(y));
        worst_add(&inverse, to_stator.beta, c * to_double(y) + s * to_double(x));
    }
    worst_check(&forward, 0.5);
    worst_check(&inverse, 0.5);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_clarke_two_phases);
    RUN_TEST(test_clarke_three_phases_drops_what_is_common);
    RUN_TEST(test_inverse_clarke_sums_to_zero);
    RUN_TEST(test_amplitude_invariant_and_sense_of_rotation);
    RUN_TEST(test_park_and_inverse);
    return UNITY_END();
}

/*
 * Resolver: angle and amplitude against double over the ranges of its corrections, and its limits.
 */
#include "iqfoc/resolver.h"
#include "reference.h"

#include <stddef.h>

#define SEED  UINT64_C(1618)
#define DRAWS 400000

static const iqfoc_resolver_t plain = {0, 0, IQ24_ONE, IQ24_ONE, IQ24(0.8), IQ24(1.2), 1, 0};

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_angle(void)
{
    uint64_t seed = SEED;
    double worst_lsb = 0.0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_resolver_t r = {random_iq24(&seed, -4.0, 4.0),
                                    random_iq24(&seed, -4.0, 4.0),
                                    random_iq24(&seed, 0.0625, 16.0),
                                    random_iq24(&seed, 0.0625, 16.0),
                                    IQ24(0.9),
                                    IQ24(1.1),
                                    1 + (iq24_t)(random_bits(&seed) % 64),
                                    random_iq24(&seed, -1.0, 1.0)};
        const double shaft = uniform(&seed, 0.0, 1.0);
        const iq24_t sin_v = to_iq24(sin(TWO_PI * shaft) / to_double(r.gain_sin)) + r.offset_sin;
        const iq24_t cos_v = to_iq24(cos(TWO_PI * shaft) / to_double(r.gain_cos)) + r.offset_cos;
        const double y = to_double(sin_v - r.offset_sin) * to_double(r.gain_sin);
        const double x = to_double(cos_v - r.offset_cos) * to_double(r.gain_cos);
        const double theta = (double)r.ratio * atan2(y, x) / TWO_PI - to_double(r.theta_0);
        const iqfoc_resolver_angle_t got = iqfoc_resolver_read(&r, sin_v, cos_v);
        /* Two roundings of 0.5 LSB, 2^-24 of the amplitude each, turn the vector by 0.71/2 pi LSB at most. */
        const double lsb = fabs(remainder(to_double(got.theta) - theta, 1.0)) * 16777216.0 / (double)r.ratio;
        worst_lsb = fmax(worst_lsb, lsb);
        TEST_ASSERT_TRUE(got.valid);
        TEST_ASSERT_TRUE(fabs(to_double(got.theta)) <= 33.0);
    }
    printf("  theta/ratio worst %.3f LSB, stated 0.64 and the input's 0.113\n", worst_lsb);
    TEST_ASSERT_TRUE(worst_lsb <= 0.64 + 0.113 && worst_lsb > 0.5);
}

static void test_amplitude(void)
{
    uint64_t seed = SEED + 1;
    for (int32_t n = 0; n < DRAWS; n++) {
        iqfoc_resolver_t r = plain;
        r.amplitude_max = random_iq24(&seed, 0.5, 2.0);
        r.amplitude_min = random_iq24(&seed, 0.1, 0.4);
        const double angle = uniform(&seed, 0.0, TWO_PI);
        /* 2 LSB inside and outside of either limit. */
        const double limit = to_double(n % 2 == 0 ? r.amplitude_max : r.amplitude_min);
        const double step = (n % 4 < 2 ? 2.0 : -2.0) / 16777216.0;
        const iq24_t y = to_iq24((limit + step) * sin(angle));
        const iq24_t x = to_iq24((limit + step) * cos(angle));
        const bool inside = n % 2 == 0 ? step < 0.0 : step > 0.0;
        TEST_ASSERT_EQUAL_INT(inside, iqfoc_resolver_read(&r, y, x).valid);
    }
}

static void test_what_is_broken(void)
{
    static const iq24_t ends[] = {IQ24_MIN, IQ24_MAX, 0, IQ24(4.0), IQ24(-4.0)};
    for (uint32_t k = 0; k < 5; k++) {
        for (uint32_t m = 0; m < 5; m++) {
            iqfoc_resolver_t r = plain;
            TEST_ASSERT_FALSE(iqfoc_resolver_read(&r, ends[k], ends[m]).valid);
            r.gain_sin = r.gain_cos = IQ24(16.0);
            r.ratio = 64;
            r.theta_0 = IQ24_ONE;
            r.offset_sin = r.offset_cos = IQ24(-4.0);
            const bool none = ends[k] == IQ24(-4.0) && ends[m] == IQ24(-4.0);
            const iqfoc_resolver_angle_t got = iqfoc_resolver_read(&r, ends[k], ends[m]);
            TEST_ASSERT_FALSE(got.valid);
            TEST_ASSERT_TRUE(!none || got.theta == -IQ24_ONE);
            TEST_ASSERT_TRUE(got.theta >= IQ24(-33.0) && got.theta <= IQ24(33.0));
        }
    }
    /* One wire off: the other alone passes where it is large, and no longer at 45 degrees. */
    TEST_ASSERT_TRUE(iqfoc_resolver_read(&plain, IQ24_ONE, 0).valid);
    TEST_ASSERT_FALSE(iqfoc_resolver_read(&plain, IQ24(0.7071), 0).valid);
}

static void refused(iqfoc_resolver_t r)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_RESOLVER, iqfoc_resolver_check(&r));
}

#define WITH(field, value)                                                                                   \
    do {                                                                                                     \
        iqfoc_resolver_t r_ = plain;                                                                         \
        r_.field = (value);                                                                                  \
        refused(r_);                                                                                         \
    } while (0)

static void test_limits(void)
{
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_resolver_check(NULL));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_resolver_check(&plain));
    const iqfoc_resolver_t low = {IQ24(-4.0), IQ24(-4.0), IQ24(0.0625), IQ24(0.0625), 1, 2, 1, -IQ24_ONE};
    const iqfoc_resolver_t high = {IQ24(4.0),     IQ24(4.0), IQ24(16.0), IQ24(16.0),
                                   IQ24(2.0) - 1, IQ24(2.0), 64,         IQ24_ONE};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_resolver_check(&low));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_resolver_check(&high));
    WITH(offset_sin, IQ24(4.0) + 1);
    WITH(offset_cos, IQ24(-4.0) - 1);
    WITH(gain_sin, IQ24(0.0625) - 1);
    WITH(gain_cos, IQ24(16.0) + 1);
    WITH(amplitude_min, 0);
    WITH(amplitude_min, plain.amplitude_max);
    WITH(amplitude_max, IQ24(2.0) + 1);
    WITH(ratio, 0);
    WITH(ratio, 65);
    WITH(theta_0, IQ24_ONE + 1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_angle);
    RUN_TEST(test_amplitude);
    RUN_TEST(test_what_is_broken);
    RUN_TEST(test_limits);
    return UNITY_END();
}

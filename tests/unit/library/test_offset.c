/*
 * Offset calibration: mean and noise against long double over draws and extremes, its verdicts, its limits.
 */
#include "iqfoc/offset.h"
#include "reference.h"

#include <stddef.h>

#define SEED UINT64_C(20261122)

static const iqfoc_offset_limits_t usual = {0, 6, IQ24(0.1), IQ24(0.02)};

void setUp(void)
{
}

void tearDown(void)
{
}

/* A sum of twelve uniform numbers: deviation 1. */
static double bell(uint64_t *seed)
{
    double sum = -6.0;
    for (int32_t k = 0; k < 12; k++) {
        sum += uniform(seed, 0.0, 1.0);
    }
    return sum;
}

static void add(long double *sum, long double *squares, iq24_t x)
{
    *sum += x;
    *squares += (long double)x * x;
}

static void test_mean_and_noise(void)
{
    uint64_t seed = SEED;
    worst mean = {"offset", 0.0};
    double low = 0.0;
    double high = -10.0;
    for (int32_t n = 0; n < 3000; n++) {
        const uint32_t log2 = 2 + (uint32_t)(random_bits(&seed) % 9);
        const iqfoc_offset_limits_t limits = {0, log2, IQ24_ONE, IQ24(0.125)};
        const double place = uniform(&seed, -0.9, 0.9);
        const double sigma = pow(10.0, uniform(&seed, -7.0, -2.0));
        const uint32_t count = UINT32_C(1) << log2;
        iqfoc_offset_t o;
        long double sum = 0.0L;
        long double squares = 0.0L;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &limits));
        for (uint32_t k = 0; k < count; k++) {
            const iqfoc_abc_t i = {to_iq24(place + sigma * bell(&seed)), 0, 0};
            TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_BUSY, o.verdict);
            TEST_ASSERT_EQUAL_INT32(0, o.offset.a);
            add(&sum, &squares, i.a);
            (void)iqfoc_offset_step(&o, i);
        }
        const long double m = sum / count;
        const double rms = (double)sqrtl(fmaxl(squares / count - m * m, 0.0L));
        TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, o.verdict);
        worst_add(&mean, o.offset.a, (double)(m / 16777216.0L));
        low = fmin(low, o.noise.a - rms);
        high = fmax(high, o.noise.a - rms);
        TEST_ASSERT_EQUAL_INT32(0, o.noise.b);
    }
    worst_check(&mean, 0.5);
    printf("  noise %.3f ... %.3f LSB off, stated -1 ... 0.14\n", low, high);
    TEST_ASSERT_TRUE(low >= -1.0 && low < -0.75);
    TEST_ASSERT_TRUE(high <= 0.14 && high > 0.07);
}

/* All samples at both ends of what is summed, for as long as can be: no sum overflows, and the noise is exact. */
static void test_longest_and_widest(void)
{
    const iqfoc_offset_limits_t limits = {0, 16, IQ24_ONE, IQ24(0.125)};
    const iq24_t far = IQ24(0.125);
    iqfoc_offset_t o;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &limits));
    for (uint32_t k = 0; k < UINT32_C(1) << 16; k++) {
        const iqfoc_abc_t i = {k == 0 ? 0 : far, k == 0 ? 0 : -far, k % 2 == 0 ? far / 2 : -far / 2};
        (void)iqfoc_offset_step(&o, i);
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, o.verdict);
    TEST_ASSERT_EQUAL_INT32(far - 32, o.offset.a); /* the one sample at 0 takes 2^21/2^16 off */
    TEST_ASSERT_EQUAL_INT32(-far + 32, o.offset.b);
    TEST_ASSERT_EQUAL_INT32(0, o.offset.c);
    TEST_ASSERT_EQUAL_INT32(far / 2, o.noise.c);
}

static iqfoc_offset_t calibrated(const iqfoc_offset_limits_t *limits, iqfoc_abc_t even, iqfoc_abc_t odd)
{
    iqfoc_offset_t o;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, limits));
    for (uint32_t k = 0; k < limits->settle + (UINT32_C(1) << limits->count_log2); k++) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_BUSY, o.verdict);
        (void)iqfoc_offset_step(&o, k % 2 == 0 ? even : odd);
    }
    return o;
}

static iqfoc_abc_t phases(double a, double b, double c)
{
    const iqfoc_abc_t i = {to_iq24(a), to_iq24(b), to_iq24(c)};
    return i;
}

static void test_verdicts(void)
{
    const iqfoc_abc_t at_limit = {IQ24(0.1), IQ24(-0.1), 0};
    iqfoc_offset_t o = calibrated(&usual, at_limit, at_limit);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, o.verdict);
    TEST_ASSERT_EQUAL_UINT32(0, o.faulty);
    const iqfoc_abc_t beyond = {IQ24(0.1) + 1, 0, IQ24(-0.1) - 1};
    o = calibrated(&usual, beyond, beyond);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_OUT_OF_RANGE, o.verdict);
    TEST_ASSERT_EQUAL_UINT32(5, o.faulty);
    const iqfoc_abc_t quiet = phases(0.02, 0.02, 0.02);
    o = calibrated(&usual, quiet, phases(-0.02, -0.02, -0.02));
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, o.verdict); /* rms is the limit itself */
    o = calibrated(&usual, quiet, phases(-0.02, -0.0201, -0.02));
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_NOISY, o.verdict);
    TEST_ASSERT_EQUAL_UINT32(2, o.faulty);
    /* Both faults: the offset's is said. */
    o = calibrated(&usual, phases(0.5, 0.03, 0.0), phases(0.5, -0.03, 0.0));
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_OUT_OF_RANGE, o.verdict);
    TEST_ASSERT_EQUAL_UINT32(1, o.faulty);
    /* A sensor that jumps from end to end, and one whose first sample alone was wrong. */
    const iqfoc_abc_t top = {IQ24_MAX, 0, 0};
    const iqfoc_abc_t bottom = {IQ24_MIN, 0, 0};
    o = calibrated(&usual, top, bottom);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_OUT_OF_RANGE, o.verdict);
    o = calibrated(&usual, bottom, top);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_OUT_OF_RANGE, o.verdict);
    const iqfoc_offset_limits_t wide = {0, 2, IQ24_ONE, IQ24(0.125)};
    for (uint32_t sensor = 0; sensor < 3; sensor++) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &wide));
        for (uint32_t k = 0; k < 4; k++) {
            const double first = k == 0 ? -0.5 : 0.0;
            (void)iqfoc_offset_step(
                &o, phases(sensor == 0 ? first : 0.0, sensor == 1 ? first : 0.0, sensor == 2 ? first : 0.0));
        }
        TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_NOISY, o.verdict);
        TEST_ASSERT_EQUAL_UINT32(UINT32_C(1) << sensor, o.faulty);
    }
    TEST_ASSERT_EQUAL_INT32(IQ24(0.125), o.noise.c);
}

static void test_settling_is_passed_over_and_the_verdict_stays(void)
{
    const iqfoc_offset_limits_t limits = {100, 4, IQ24(0.1), IQ24(0.02)};
    iqfoc_offset_t o;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &limits));
    for (uint32_t k = 0; k < 100; k++) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_BUSY, iqfoc_offset_step(&o, phases(3.0 - 0.03 * k, 0.0, 9.0)));
    }
    for (uint32_t k = 0; k < 16; k++) {
        (void)iqfoc_offset_step(&o, phases(0.05, -0.05, 0.0));
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, o.verdict);
    for (uint32_t k = 0; k < 50; k++) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_GOOD, iqfoc_offset_step(&o, phases(9.0, 9.0, 9.0)));
    }
    TEST_ASSERT_EQUAL_INT32(IQ24(0.05), o.offset.a);
    const iqfoc_abc_t i = iqfoc_offset_removed(&o, phases(1.05, -1.05, 0.5));
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, i.a);
    TEST_ASSERT_EQUAL_INT32(-IQ24_ONE, i.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5), i.c);
    const iqfoc_abc_t ends = {IQ24_MAX, IQ24_MIN, IQ24(15.9)};
    const iqfoc_abc_t held = iqfoc_offset_removed(&o, ends);
    TEST_ASSERT_EQUAL_INT32(IQ24(15.9), held.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(-15.9), held.b);
    TEST_ASSERT_EQUAL_INT32(IQ24(15.9), held.c);
}

static void refused(iqfoc_offset_limits_t limits, bool is)
{
    iqfoc_offset_t o = {.seen = 77};
    TEST_ASSERT_EQUAL_INT(is ? IQFOC_ERROR_OFFSET_LIMITS : IQFOC_OK, iqfoc_offset_init(&o, &limits));
    TEST_ASSERT_EQUAL_UINT32(is ? 77 : 0, o.seen); /* untouched */
}

static void test_limits(void)
{
    iqfoc_offset_t o;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_offset_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_offset_init(&o, NULL));
    refused((iqfoc_offset_limits_t){UINT32_MAX, 2, 1, 1}, false);
    refused((iqfoc_offset_limits_t){0, 16, IQ24_ONE, IQ24(0.125)}, false);
    refused((iqfoc_offset_limits_t){0, 1, 1, 1}, true);
    refused((iqfoc_offset_limits_t){0, 17, 1, 1}, true);
    refused((iqfoc_offset_limits_t){0, 2, 0, 1}, true);
    refused((iqfoc_offset_limits_t){0, 2, IQ24_ONE + 1, 1}, true);
    refused((iqfoc_offset_limits_t){0, 2, 1, 0}, true);
    refused((iqfoc_offset_limits_t){0, 2, 1, IQ24(0.125) + 1}, true);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mean_and_noise);
    RUN_TEST(test_longest_and_widest);
    RUN_TEST(test_verdicts);
    RUN_TEST(test_settling_is_passed_over_and_the_verdict_stays);
    RUN_TEST(test_limits);
    return UNITY_END();
}

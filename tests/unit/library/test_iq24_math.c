/*
 * iq24_math.h against the exact functions of the integer arguments, in double or in integers alone. Double is
 * exact to 2^-27 LSB at worst.
 * Bounds are two-sided where a sweep is exhaustive: better than documented fails too, as the documentation is
 * then wrong.
 */
#include "iqfoc/iq24_math.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "iq24_samples.h"
#include "unity.h"

#define SEED UINT64_C(20190711)
#define TAU  6.283185307179586476925

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Sine and cosine ---- */

typedef iq24_sincos_t (*sincos_t)(iq24_t turns);

/* The largest error of either output in LSB over all 2^24 angles. */
static double sincos_worst_error(sincos_t function)
{
    double worst = 0;
    for (int32_t angle = 0; angle < IQ24_ONE; angle += IQFOC_TEST_STRIDE) {
        double radians = TAU * angle / IQ24_ONE;
        iq24_sincos_t got = function(angle);
        double sin_error = fabs((double)got.sin - sin(radians) * IQ24_ONE);
        double cos_error = fabs((double)got.cos - cos(radians) * IQ24_ONE);
        worst = fmax(worst, fmax(sin_error, cos_error));
    }
    return worst;
}

static void sincos_of_every_angle_within_its_bound(void)
{
    double worst = sincos_worst_error(iq24_sincos);
    TEST_ASSERT_TRUE(worst <= 0.51);
    if (IQFOC_TEST_STRIDE == 1) {
        TEST_ASSERT_TRUE(worst > 0.50);
    }
}

/* Right at all multiples of 45 degrees, and off by 3.6e-3 in a narrow span next to -90 degrees. */
static iq24_sincos_t sincos_with_a_bad_span(iq24_t turns)
{
    iq24_sincos_t result = iq24_sincos(turns);
    int32_t from_270_degrees = turns - IQ24_ONE / 4 * 3;
    if (from_270_degrees > 0 && from_270_degrees < IQ24_ONE / 4096) {
        result.cos += IQ24(3.6e-3);
    }
    return result;
}

static void the_sweep_sees_a_bad_span(void)
{
    TEST_ASSERT_TRUE(sincos_worst_error(sincos_with_a_bad_span) > 60000.0);
}

static void sincos_is_exact_at_quarter_turns(void)
{
    static const iq24_t expected[4][2] = {{0, IQ24_ONE}, {IQ24_ONE, 0}, {0, -IQ24_ONE}, {-IQ24_ONE, 0}};
    for (int quarter = -512; quarter < 512; quarter++) {
        iq24_sincos_t got = iq24_sincos(quarter * (IQ24_ONE / 4));
        TEST_ASSERT_EQUAL_INT32(expected[quarter & 3][0], got.sin);
        TEST_ASSERT_EQUAL_INT32(expected[quarter & 3][1], got.cos);
    }
}

static void sincos_drops_whole_turns_and_stays_within_one(void)
{
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < 2000000 / IQFOC_TEST_STRIDE; i++) {
        iq24_t angle = iq24_random_any(&random);
        int32_t within = angle % IQ24_ONE;
        iq24_sincos_t got = iq24_sincos(angle);
        iq24_sincos_t same = iq24_sincos_inline(within < 0 ? within + IQ24_ONE : within);
        bool in_range = labs(got.sin) <= IQ24_ONE && labs(got.cos) <= IQ24_ONE;
        if (got.sin != same.sin || got.cos != same.cos || !in_range) {
            TEST_FAIL_MESSAGE("iq24_sincos");
        }
    }
    iq24_sincos_t lowest = iq24_sincos(IQ24_MIN);
    TEST_ASSERT_EQUAL_INT32(0, lowest.sin);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, lowest.cos);
    iq24_sincos_t highest = iq24_sincos(IQ24_MAX);
    TEST_ASSERT_EQUAL_INT32(-6, highest.sin); /* -2 pi LSB */
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, highest.cos);
}

/* ---- atan2 ---- */

static double atan2_worst;

static void expect_atan2(iq24_t y, iq24_t x)
{
    iq24_t got = iq24_atan2(y, x);
    double error = got - atan2((double)y, (double)x) / TAU * IQ24_ONE;
    if (error < -IQ24_ONE / 2) {
        error += IQ24_ONE; /* -0.5 turn stands for +0.5 */
    }
    atan2_worst = fmax(atan2_worst, fabs(error));
    if (fabs(error) > 0.64 || got < -IQ24_ONE / 2 || got >= IQ24_ONE / 2) {
        char message[120];
        snprintf(message, sizeof message, "iq24_atan2(%ld, %ld) = %ld is off by %.3f LSB", (long)y, (long)x,
                 (long)got, (double)error);
        TEST_FAIL_MESSAGE(message);
    }
}

/* What src/arm_sincos.c takes for granted where it adds products of signed halves. */
static void no_sine_has_the_low_half_that_overflows(void)
{
    for (int32_t n = 0; n < IQ24_SINE_CELLS + IQ24_SINE_CELLS / 4; n++) {
        TEST_ASSERT_TRUE((iq24_sine_q30[n] & 0xFFFF) != 0x8000);
        TEST_ASSERT_TRUE(abs(iq24_sine_q30[n]) <= INT32_C(1) << 30);
    }
}

static void atan2_of_extremes_axes_and_octant_borders(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            if (extremes[i] != 0 || extremes[j] != 0) {
                expect_atan2(extremes[i], extremes[j]);
            }
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, iq24_atan2(0, 0));
    for (int i = 0; i < count; i++) {
        iq24_t size = extremes[i];
        if (size <= 0) {
            continue;
        }
        TEST_ASSERT_EQUAL_INT32(0, iq24_atan2(0, size));
        TEST_ASSERT_EQUAL_INT32(IQ24(0.125), iq24_atan2(size, size));
        TEST_ASSERT_EQUAL_INT32(IQ24(0.25), iq24_atan2(size, 0));
        TEST_ASSERT_EQUAL_INT32(IQ24(0.375), iq24_atan2(size, -size));
        TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), iq24_atan2(0, -size));
        TEST_ASSERT_EQUAL_INT32(IQ24(-0.375), iq24_atan2(-size, -size));
        TEST_ASSERT_EQUAL_INT32(IQ24(-0.25), iq24_atan2(-size, 0));
        TEST_ASSERT_EQUAL_INT32(IQ24(-0.125), iq24_atan2(-size, size));
    }
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.5), iq24_atan2(0, IQ24_MIN));
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.375), iq24_atan2(IQ24_MIN, IQ24_MIN));
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25), iq24_atan2(IQ24_MIN, 0));
}

static void atan2_on_circles_of_every_radius(void)
{
    /* All integer points of the smallest ones, ... */
    for (int32_t y = -64; y <= 64; y++) {
        for (int32_t x = -64; x <= 64; x++) {
            if (x != 0 || y != 0) {
                expect_atan2(y, x);
            }
        }
    }
    /* ... and radii 2^0 ... 2^31 by steps of 2^(1/4), 50,000 angles each. */
    for (int step = 0; step <= 124; step++) {
        double radius = fmin(exp2(step / 4.0), 2147483647.0);
        for (int32_t i = 0; i < 50000; i += IQFOC_TEST_STRIDE) {
            double radians = TAU * (i + 0.25) / 50000;
            expect_atan2((iq24_t)lround(radius * sin(radians)), (iq24_t)lround(radius * cos(radians)));
        }
    }
}

static void atan2_of_random_vectors(void)
{
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < 5000000 / IQFOC_TEST_STRIDE; i++) {
        iq24_t y = iq24_random_magnitude(&random);
        iq24_t x = iq24_random_magnitude(&random);
        if (x != 0 || y != 0) {
            expect_atan2(y, x);
        }
        expect_atan2(iq24_random_any(&random), iq24_random_any(&random) | 1);
    }
    if (IQFOC_TEST_STRIDE == 1) {
        TEST_ASSERT_TRUE(atan2_worst > 0.62);
    }
}

static void atan2_is_odd_in_y_and_mirrored_in_x(void)
{
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < 2000000 / IQFOC_TEST_STRIDE; i++) {
        iq24_t y = iq24_random_magnitude(&random);
        iq24_t x = iq24_random_magnitude(&random);
        iq24_t angle = iq24_atan2(y, x);
        bool half_turn = angle == -IQ24_ONE / 2;
        bool odd = half_turn || y == 0 || iq24_atan2(-y, x) == -angle;
        iq24_t mirrored = (y < 0 ? -IQ24_ONE / 2 : IQ24_ONE / 2) - angle;
        bool symmetric = x == 0 || half_turn || mirrored == IQ24_ONE / 2 || iq24_atan2(y, -x) == mirrored;
        if (!odd || !symmetric) {
            TEST_FAIL_MESSAGE("iq24_atan2: symmetry");
        }
    }
}

/* ---- Square root ---- */

static double sqrt_worst;
static double sqrt_worst_below_64;

static void expect_sqrt(int32_t x)
{
    double error = iq24_sqrt(x) - sqrt((double)x * IQ24_ONE);
    sqrt_worst = fmax(sqrt_worst, fabs(error));
    sqrt_worst_below_64 = x < IQ24(64.0) ? fmax(sqrt_worst_below_64, fabs(error)) : sqrt_worst_below_64;
    if (fabs(error) > (x < IQ24(64.0) ? 0.57 : 0.63)) {
        char message[80];
        snprintf(message, sizeof message, "iq24_sqrt(%ld) is off by %.3f LSB", (long)x, error);
        TEST_FAIL_MESSAGE(message);
    }
}

static void sqrt_of_a_dense_sweep_within_its_bound(void)
{
    for (int32_t x = 1; x < 1 << 20; x++) {
        expect_sqrt(x);
    }
    /* 101 and the stride do not divide a power of two. */
    for (int64_t x = 1 << 20; x <= INT32_MAX; x += INT64_C(101) * IQFOC_TEST_STRIDE) {
        expect_sqrt((int32_t)x);
    }
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int32_t off = -200; off <= 200; off++) {
            int64_t x = (int64_t)extremes[i] + off;
            if (x > 0 && x <= INT32_MAX) {
                expect_sqrt((int32_t)x);
            }
        }
    }
    if (IQFOC_TEST_STRIDE == 1) {
        TEST_ASSERT_TRUE(sqrt_worst > 0.62);
        TEST_ASSERT_TRUE(sqrt_worst_below_64 > 0.56);
    }
}

static void sqrt_is_exact_where_the_root_is_a_number(void)
{
    /*
     * root^2 / 2^24 is an integer where root is a multiple of 2^12; below 128, that is root < 11585 * 2^12.
     */
    for (int64_t root = 0; root * root < INT64_C(1) << 31; root++) {
        TEST_ASSERT_EQUAL_INT32(root * 4096, iq24_sqrt((iq24_t)(root * root)));
    }
}

static void sqrt_of_zero_and_below_is_zero(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        if (extremes[i] <= 0) {
            TEST_ASSERT_EQUAL_INT32(0, iq24_sqrt(extremes[i]));
        }
    }
}

/* ---- Division ---- */

/* a / b to nearest, ties away from zero: in sign and magnitude with a 64-bit division. */
static iq24_t reference_div(iq24_t a, iq24_t b)
{
    int64_t n = a < 0 ? -(int64_t)a : a;
    int64_t d = b < 0 ? -(int64_t)b : b;
    bool negative = (a < 0) != (b < 0);
    if (d == 0) {
        return a == 0 ? 0 : (negative ? INT32_MIN : INT32_MAX);
    }
    int64_t quotient = (2 * n * IQ24_ONE + d) / (2 * d);
    quotient = negative ? -quotient : quotient;
    if (quotient > INT32_MAX) {
        return INT32_MAX;
    }
    return quotient < INT32_MIN ? INT32_MIN : (iq24_t)quotient;
}

static void expect_div(iq24_t a, iq24_t b)
{
    if (iq24_div(a, b) != reference_div(a, b)) {
        char message[120];
        snprintf(message, sizeof message, "iq24_div(%ld, %ld) = %ld instead of %ld", (long)a, (long)b,
                 (long)iq24_div(a, b), (long)reference_div(a, b));
        TEST_FAIL_MESSAGE(message);
    }
}

static void division_is_the_exact_quotient_rounded_once(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            expect_div(extremes[i], extremes[j]);
        }
    }
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < 5000000 / IQFOC_TEST_STRIDE; i++) {
        iq24_t a = iq24_random_magnitude(&random);
        iq24_t b = iq24_random_magnitude(&random);
        expect_div(a, b);
        a = iq24_random_any(&random);
        expect_div(a, iq24_random_any(&random));
        /* Next to the limit of saturation, and quotients that end on or next to a tie. */
        int64_t edge = (int64_t)b * 128 + (int32_t)(iq24_random_bits(&random) % 7) - 3;
        expect_div(iq24_sat(edge), b);
        expect_div(iq24_mul_round(a, b), b);
        expect_div(b, (iq24_t)((uint32_t)1 << (i % 31)));
    }
}

static void division_by_zero_and_overflow_saturate(void)
{
    TEST_ASSERT_EQUAL_INT32(0, iq24_div(0, 0));
    TEST_ASSERT_EQUAL_INT32(IQ24_MAX, iq24_div(1, 0));
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_div(-1, 0));
    TEST_ASSERT_EQUAL_INT32(IQ24_MAX, iq24_div(IQ24_MAX, 0));
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_div(IQ24_MIN, 0));
    TEST_ASSERT_EQUAL_INT32(IQ24_MAX, iq24_div(IQ24_MIN, -IQ24_ONE));
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_div(IQ24_MIN, IQ24_ONE));
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, iq24_div(IQ24_MIN, IQ24_MIN));
    TEST_ASSERT_EQUAL_INT32(IQ24_MAX, iq24_div(IQ24_MIN, -1));
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_div(IQ24_MAX, -1));
    /* 0.5 and -0.5 LSB: ties go away from zero. */
    TEST_ASSERT_EQUAL_INT32(1, iq24_div(1, 2 * IQ24_ONE));
    TEST_ASSERT_EQUAL_INT32(-1, iq24_div(1, -2 * IQ24_ONE));
}

int main(void)
{
    printf("seed %lu\n", (unsigned long)SEED);
    UNITY_BEGIN();
    RUN_TEST(sincos_of_every_angle_within_its_bound);
    RUN_TEST(the_sweep_sees_a_bad_span);
    RUN_TEST(sincos_is_exact_at_quarter_turns);
    RUN_TEST(sincos_drops_whole_turns_and_stays_within_one);
    RUN_TEST(no_sine_has_the_low_half_that_overflows);
    RUN_TEST(atan2_of_extremes_axes_and_octant_borders);
    RUN_TEST(atan2_on_circles_of_every_radius);
    RUN_TEST(atan2_of_random_vectors);
    RUN_TEST(atan2_is_odd_in_y_and_mirrored_in_x);
    RUN_TEST(sqrt_of_a_dense_sweep_within_its_bound);
    RUN_TEST(sqrt_is_exact_where_the_root_is_a_number);
    RUN_TEST(sqrt_of_zero_and_below_is_zero);
    RUN_TEST(division_is_the_exact_quotient_rounded_once);
    RUN_TEST(division_by_zero_and_overflow_saturate);
    printf("largest errors: atan2 %.4f, sqrt %.4f, below 64.0 %.4f LSB\n", atan2_worst, sqrt_worst,
           sqrt_worst_below_64);
    return UNITY_END();
}

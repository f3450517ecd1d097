/*
 * Between IQmath and iqfoc: the conversions of iqfoc_iqmath.h, and the differences that docs/from-iqmath.md
 * gives.
 */
#include "compare.h"
#include "documented.h"

#include "iqfoc_iqmath.h"

#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_same_number(void)
{
    const int32_t values[5] = {0, 1, -1, IQ24_MAX, IQ24_MIN};
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_INT32(values[k], iqfoc_from_iq24(values[k]));
        TEST_ASSERT_EQUAL_INT32(values[k], iqfoc_to_iq24(values[k]));
        TEST_ASSERT_EQUAL_INT32(values[k], iqfoc_from_iqn(values[k], 24));
        TEST_ASSERT_EQUAL_INT32(values[k], iqfoc_to_iqn(values[k], 24));
    }
}

/* In exact doubles: to nearest, ties up, held at the ends. */
static double nearest(double x)
{
    return fmin(fmax(floor(x + 0.5), -2147483648.0), 2147483647.0);
}

static void test_other_formats(void)
{
    for (uint32_t n = 1; n <= 30; n++) {
        const double unit = ldexp(1.0, 24 - (int)n);
        for (int32_t k = -5000; k <= 5000; k++) {
            const int32_t x = k < 0 ? -(k * k * 85) : k * k * 85 + (k & 7);
            TEST_ASSERT_EQUAL_DOUBLE(nearest(x * unit), iqfoc_from_iqn(x, n));
            TEST_ASSERT_EQUAL_DOUBLE(nearest(x / unit), iqfoc_to_iqn(x, n));
        }
        TEST_ASSERT_EQUAL_DOUBLE(nearest(IQ24_MIN * unit), iqfoc_from_iqn(IQ24_MIN, n));
        TEST_ASSERT_EQUAL_DOUBLE(nearest(IQ24_MAX * unit), iqfoc_from_iqn(IQ24_MAX, n));
        TEST_ASSERT_EQUAL_DOUBLE(nearest(IQ24_MIN / unit), iqfoc_to_iqn(IQ24_MIN, n));
        TEST_ASSERT_EQUAL_DOUBLE(nearest(IQ24_MAX / unit), iqfoc_to_iqn(IQ24_MAX, n));
    }
}

static void test_angles(void)
{
    for (int32_t turns = -3 * IQ24_ONE; turns <= 3 * IQ24_ONE; turns += 4099) {
        const iq24_t pu = iqfoc_to_angle_pu(turns);
        const iq24_t back = iqfoc_from_angle_pu(turns);
        TEST_ASSERT_TRUE(pu >= 0 && pu < IQ24_ONE && back >= -IQ24_ONE / 2 && back < IQ24_ONE / 2);
        TEST_ASSERT_EQUAL_INT32(0, (turns - pu) % IQ24_ONE);
        TEST_ASSERT_EQUAL_INT32(0, (turns - back) % IQ24_ONE);
    }
}

/* What the page says of each row; and the comparison sees what differs. */
static void test_differences(void)
{
    static const int32_t largest[IQMATH_ROWS] = {0, 0, 0, 1, 1, 1, 0, 0, 0};
    iqmath_row_t rows[IQMATH_ROWS];
    iqmath_compare(rows, 100000);
    for (int k = 0; k < IQMATH_ROWS; k++) {
        TEST_ASSERT_EQUAL_INT32_MESSAGE(largest[k], rows[k].largest, rows[k].ti);
    }
}

/* A few values by hand, so that the model of the documents is not only compared with itself. */
static void test_documented_arithmetic(void)
{
    TEST_ASSERT_EQUAL_INT32(-1, ti_mpy(-1, 1)); /* floor, not towards 0 */
    TEST_ASSERT_EQUAL_INT32(0, ti_rmpy(-1, 1));
    TEST_ASSERT_EQUAL_INT32(1, ti_rmpy(1, 1 << 23));                  /* a tie goes up */
    TEST_ASSERT_EQUAL_INT32(0, ti_mpy(16 * IQ24_ONE, 16 * IQ24_ONE)); /* 256 wraps to 0 */
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, ti_rsmpy(16 * IQ24_ONE, 16 * IQ24_ONE));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, ti_rsmpy(-16 * IQ24_ONE, 16 * IQ24_ONE));
    TEST_ASSERT_EQUAL_INT32(1677721, ti_constant(0.1)); /* 1677721.6 */
    TEST_ASSERT_EQUAL_INT32(-1677721, ti_constant(-0.1));
    TEST_ASSERT_EQUAL_INT32(-1, ti_div_power(-1, 3));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_same_number);
    RUN_TEST(test_other_formats);
    RUN_TEST(test_angles);
    RUN_TEST(test_differences);
    RUN_TEST(test_documented_arithmetic);
    return UNITY_END();
}

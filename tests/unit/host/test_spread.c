/* Mean, standard deviation and largest size (sim_host/base/spread.h) of numbers with known ones, and of none. */
#include "base/spread.h"

#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_of_known_numbers(void)
{
    static const double x[] = {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0};
    spread s = {0};
    for (int n = 0; n < 7; n++) {
        spread_add(&s, x[n]);
    }
    spread_add(&s, 9.0);
    TEST_ASSERT_EQUAL_INT64(8, s.count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 5.0, spread_mean(&s));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0, spread_deviation(&s));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, sqrt(29.0), spread_rms(&s));
    TEST_ASSERT_TRUE(spread_most(&s) == 9.0);
    spread_add(&s, -10.0);
    TEST_ASSERT_TRUE(spread_most(&s) == 10.0);
}

static void test_equal_numbers_have_no_deviation(void)
{
    spread s = {0};
    for (int n = 0; n < 1000; n++) {
        spread_add(&s, 0.1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.0, spread_deviation(&s)); /* not NAN, by the rounding of the squares */
}

static void test_none_is_nan(void)
{
    const spread s = {0};
    TEST_ASSERT_TRUE(isnan(spread_mean(&s)) && isnan(spread_deviation(&s)) && isnan(spread_rms(&s)) &&
                     isnan(spread_most(&s)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_of_known_numbers);
    RUN_TEST(test_equal_numbers_have_no_deviation);
    RUN_TEST(test_none_is_nan);
    return UNITY_END();
}

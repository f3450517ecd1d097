/*
 * A diagnosis' own functions (sim_host/diagnose/result.h). The program is linked so that what is given back is seen.
 */
#include "diagnose/result.h"
#include "diagnose/tell/values.h"

#include <stdlib.h>
#include <string.h>
#include <unity.h>

enum { SERIES = 5 };

static void *series[SERIES];
static int freed[SERIES];

void __wrap_free(void *p);
void __real_free(void *p);

void __wrap_free(void *p)
{
    for (size_t k = 0; p && k < SERIES; k++) {
        freed[k] += p == series[k] ? 1 : 0;
    }
    __real_free(p);
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void all_series_are_given_back_once(void)
{
    diagnosis d = {.causes = 3};
    d.error_nominal = calloc(1, sizeof *d.error_nominal);
    d.error_extended = calloc(1, sizeof *d.error_extended);
    d.free_nominal = calloc(1, sizeof *d.free_nominal);
    d.free_extended = calloc(1, sizeof *d.free_extended);
    d.held_out = calloc(1, 1);
    void *const made[SERIES] = {d.error_nominal, d.error_extended, d.free_nominal, d.free_extended,
                                d.held_out};
    memcpy(series, made, sizeof series);
    diagnosis_free(&d);
    for (size_t k = 0; k < SERIES; k++) {
        TEST_ASSERT_EQUAL_INT(1, freed[k]);
    }
    TEST_ASSERT_NULL(d.error_nominal);
    TEST_ASSERT_NULL(d.held_out);
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    diagnosis_free(&d); /* nothing is there any more */
    TEST_ASSERT_EQUAL_INT(1, freed[0]);
}

static void each_verdict_has_its_id(void)
{
    TEST_ASSERT_EQUAL_STRING("clean", diagnosis_verdict_id(VERDICT_CLEAN));
    TEST_ASSERT_EQUAL_STRING("explained", diagnosis_verdict_id(VERDICT_EXPLAINED));
    TEST_ASSERT_EQUAL_STRING("partly", diagnosis_verdict_id(VERDICT_PARTLY));
    TEST_ASSERT_EQUAL_STRING("unexplained", diagnosis_verdict_id(VERDICT_UNEXPLAINED));
}

static void expect_saturation(double value, double a, double b, double low, double high)
{
    diagnosis_parameter p = {.value = value, .low = a, .high = b};
    values_bound_saturation(1e6, &p);
    TEST_ASSERT_EQUAL_DOUBLE(low, p.low);
    TEST_ASSERT_EQUAL_DOUBLE(high, p.high);
    TEST_ASSERT_TRUE(p.low <= value && value <= p.high);
}

/* 0 means that nothing saturates, which is a current beyond all others and not one below them. */
static void a_saturation_current_lies_in_its_interval(void)
{
    expect_saturation(28.9, 0.0, 10.6, 10.6, 1e6);
    expect_saturation(28.9, 20.0, 50.0, 20.0, 50.0);
    expect_saturation(28.9, 0.0, 0.0, 0.0, 1e6);
    expect_saturation(0.0, -40.0, 40.0, 0.0, 1e6);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_series_are_given_back_once);
    RUN_TEST(each_verdict_has_its_id);
    RUN_TEST(a_saturation_current_lies_in_its_interval);
    return UNITY_END();
}

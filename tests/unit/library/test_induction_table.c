/*
 * The induction machine's table: the exact form is exact under PWM too, the error of the papers' form is visible, and
 * the firmware's numbers follow the table.
 */
#include "induction/induction_table.h"
#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void check(double f_rotor_Hz)
{
    induction_errors p;
    error e = {0};
    TEST_ASSERT_TRUE(induction_errors_at(f_rotor_Hz, &p, &e));
    TEST_ASSERT_TRUE(p.modulation_index <= 0.95 + 1e-9);
    /* What the pulses leave, and what is left when they are counted. */
    TEST_ASSERT_TRUE(p.prediction_exact < (f_rotor_Hz > 0.0 ? 0.5 : 1.2));
    TEST_ASSERT_TRUE(p.prediction_exact < 0.45 * p.prediction_quasi_discrete);
    TEST_ASSERT_TRUE(p.mean_exact < p.mean_quasi_discrete);
    TEST_ASSERT_TRUE(p.prediction_pulses_iq24 < 0.02 && p.mean_pulses_iq24 < 0.02);
    TEST_ASSERT_TRUE(p.prediction_pulses_iq24 < 0.05 * p.prediction_exact);
    TEST_ASSERT_TRUE(p.mean_pulses_iq24 < 0.05 * p.mean_exact);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, p.prediction_exact, p.prediction_exact_iq24);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, p.mean_exact, p.mean_exact_iq24);
    if (p.sffr < 25.0) {
        TEST_ASSERT_TRUE(p.prediction_quasi_discrete < 0.2 * p.prediction_standard);
        TEST_ASSERT_TRUE(p.mean_quasi_discrete < p.mean_standard);
    }
}

static void test_every_point(void)
{
    for (int n = 0; n < INDUCTION_POINTS; n++) {
        check(induction_table_Hz[n]);
    }
    check(-60.0);
}

static void test_flux_weakening(void)
{
    induction_errors slow;
    induction_errors fast;
    error e = {0};
    TEST_ASSERT_TRUE(induction_errors_at(10.0, &slow, &e));
    TEST_ASSERT_TRUE(induction_errors_at(120.0, &fast, &e));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 90.0, slow.i_d_A);
    TEST_ASSERT_TRUE(fast.i_d_A < 80.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.95, fast.modulation_index);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, hypot(slow.i_d_A, slow.i_q_A), hypot(fast.i_d_A, fast.i_q_A));
}

static void test_too_fast_is_refused(void)
{
    induction_errors p;
    error e = {0};
    TEST_ASSERT_FALSE(induction_errors_at(170.0, &p, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_point);
    RUN_TEST(test_flux_weakening);
    RUN_TEST(test_too_fast_is_refused);
    return UNITY_END();
}

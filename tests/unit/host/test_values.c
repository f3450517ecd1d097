/*
 * Intervals of a cause's values (sim_host/diagnose/tell/values.h): of all fitted columns that move them, and of how these lean on
 * one another.
 */
#include "diagnose/tell/values.h"
#include "diagnose_bench.h"

#include <math.h>
#include <string.h>
#include <unity.h>

static motor m;
static recording r;
static session w;

void setUp(void)
{
    error e = {0};
    const bench b = {.m = bench_motor(), .noise_A = 0.017, .seed = 20261130};
    m = bench_motor();
    r = bench_record(&b);
    w = (session){.way = SESSION_WHOLE_DRIVE};
    TEST_ASSERT_TRUE_MESSAGE(rows_prepare(&w.rows, &r, &m, &e), e.text);
    w.frame = coordinates_of(&m, &w.rows);
}

void tearDown(void)
{
    rows_free(&w.rows);
    recording_free(&r);
}

/* The half width of a value, as a share of it. */
static double told(hypothesis_id h, const char *name)
{
    diagnosis_cause cause;
    values_tell(&w, h, w.state.z, &cause);
    for (size_t k = 0; k < cause.parameters; k++) {
        const diagnosis_parameter *p = &cause.parameter[k];
        if (strcmp(p->name, name) == 0) {
            TEST_ASSERT_TRUE(p->low <= p->value && p->value <= p->high);
            return 0.5 * (p->high - p->low) / p->value;
        }
    }
    TEST_FAIL_MESSAGE(name);
    return 0.0;
}

/* Columns that are as sure as this, each by itself. */
static void sure_of(const int *column, const double *half_width, size_t n)
{
    w.certainty = (certainty){.columns = n, .inflation = 1.0};
    for (size_t k = 0; k < n; k++) {
        w.certainty.column[k] = column[k];
        w.certainty.half_width[k] = half_width[k];
        w.certainty.covariance[k][k] = half_width[k] * half_width[k];
    }
}

static void mismatch(void)
{
    w.state.set = HYPOTHESIS_BIT(H_GAIN_MISMATCH);
    w.state.z[P_GAIN_A] = 0.02;
    w.state.z[P_GAIN_B] = -0.01;
    w.state.z[P_GAIN_C] = -0.01;
}

/* Gains that are known against one another to 0.01 %, and in the mean to 0.2 %, are known to 0.2 %. */
static void gains_are_as_sure_as_their_mean(void)
{
    static const int gains[] = {P_GAIN_A, P_GAIN_B, P_GAIN_C};
    static const double half[] = {2e-3, 2e-3, 2e-3};
    mismatch();
    sure_of(gains, half, 3);
    for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 3; j++) {
            w.certainty.covariance[i][j] = 4e-6 - (i == j ? 0.0 : 1e-8);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 2e-3 / 1.02, told(H_GAIN_MISMATCH, "g_a"));
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 2e-3 / 0.99, told(H_GAIN_MISMATCH, "g_c"));
}

/* Where a search fits the differences alone, the mean has the tolerance that was fitted with them. */
static void a_tolerance_of_the_same_value_counts(void)
{
    static const int columns[] = {COLUMN_GAIN_A, COLUMN_GAIN_BC, P_GAIN_A};
    static const double half[] = {3e-4, 3e-4, 4e-4};
    mismatch();
    w.way = SESSION_SEARCH;
    sure_of(columns, half, 2);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 3e-4 / 1.02, told(H_GAIN_MISMATCH, "g_a"));
    sure_of(columns, half, 3);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 5e-4 / 1.02, told(H_GAIN_MISMATCH, "g_a"));
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, sqrt(0.25 + 1.0) * 3e-4 / 0.99, told(H_GAIN_MISMATCH, "g_b"));
}

/* What a dead time's law misses widens the others, but for a fit of the whole drive. */
static void next_to_a_dead_time_intervals_are_wider(void)
{
    static const int column[] = {P_R};
    static const double half[] = {1e-3};
    const double of_R = w.frame.scale[SCALE_R] / m.R_ohm;
    w.state.set = HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_DEAD_TIME);
    sure_of(column, half, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, of_R * (1e-3 + 0.006 * 0.02), told(H_RESISTANCE, "R"));
    w.way = SESSION_SEARCH;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, of_R * (1e-3 + 0.3 * 0.02), told(H_RESISTANCE, "R"));
    w.state.set = HYPOTHESIS_BIT(H_RESISTANCE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, of_R * (1e-3 + 0.006 * 0.02), told(H_RESISTANCE, "R"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(gains_are_as_sure_as_their_mean);
    RUN_TEST(a_tolerance_of_the_same_value_counts);
    RUN_TEST(next_to_a_dead_time_intervals_are_wider);
    return UNITY_END();
}

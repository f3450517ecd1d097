/*
 * What the tests of the diagnosis' decisions share: a view of sums that are made by hand, and a state to see it from. A
 * parabola along each coordinate says all that the rules ask of a recording. Each test program includes it once.
 */
#ifndef TESTS_UNIT_CHOOSE_FIXTURE_H
#define TESTS_UNIT_CHOOSE_FIXTURE_H

#include "diagnose/weigh/evidence.h"

#include <math.h>
#include <stdlib.h>
#include <unity.h>

#define WORST      1000.0
#define BIT        HYPOTHESIS_BIT
#define WITHIN(x)  (1e-9 * (1.0 + fabs(x)))
#define SAME(a, b) TEST_ASSERT_DOUBLE_WITHIN(WITHIN(a), a, b)

static diagnose_rows rows;
static evidence_view *view;
static fit_state state;

void setUp(void)
{
    rows = (diagnose_rows){0};
    view = calloc(1, sizeof *view);
    TEST_ASSERT_NOT_NULL(view);
    view->rows = &rows;
    view->of_least = 1.0;
    view->total.c = view->sums.c = WORST;
    state = fit_nominal();
}

void tearDown(void)
{
    free(view);
}

/* The best place along a column, and how much less the cost is there; seen from the motor file's values. */
static inline void parabola(int column, double best, double less)
{
    const double curve = less / (best * best);
    view->total.h[column][column] = view->sums.h[column][column] = curve;
    view->total.g[column] = view->sums.g[column] = -curve * best;
}

static inline evidence_option of(hypothesis_set set)
{
    evidence_option option;
    TEST_ASSERT_TRUE(evidence_cost(view, &state, set, &option));
    return option;
}

#endif

/*
 * What laws may err by, marginalised (sim_host/diagnose/weigh/tolerance.h): against the minimum over those errors, found
 * one by one, on sums of two operating points that are made by hand.
 */
#include "diagnose/weigh/tolerance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

enum { POINTS = 2, COLUMNS = 2 };

#define BIT        HYPOTHESIS_BIT
#define SAME(a, b) TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1.0 + fabs(a)), a, b)

static diagnose_rows rows;
static size_t which[POINTS];
static fit_data data;
static fit_state state;
static gram *blocks, *sums;
static const int column[COLUMNS] = {P_R, P_PSI};

void setUp(void)
{
    rows = (diagnose_rows){.groups = POINTS};
    data = (fit_data){.rows = &rows, .block = which, .blocks = POINTS};
    state = fit_nominal();
    blocks = calloc(POINTS, sizeof *blocks);
    sums = calloc(1, sizeof *sums);
    TEST_ASSERT_TRUE(blocks && sums);
    for (size_t k = 0; k < POINTS; k++) {
        gram *b = &blocks[k];
        b->group = k;
        b->c = 1000.0 + 100.0 * (double)k;
        b->h[0][0] = 4e8;
        b->h[1][1] = 3e8 + 1e8 * (double)k;
        b->h[0][1] = b->h[1][0] = 2e8;
        b->g[0] = k == 0 ? -5e4 : 7e4;
        b->g[1] = 1e4 - 3e4 * (double)k;
    }
}

void tearDown(void)
{
    free(blocks);
    free(sums);
}

/* c + 2 g'x + x'Hx */
static double form(const gram *a, const double x[COLUMNS])
{
    double value = a->c;
    for (size_t i = 0; i < COLUMNS; i++) {
        value += 2.0 * a->g[i] * x[i];
        for (size_t j = 0; j < COLUMNS; j++) {
            value += a->h[i][j] * x[i] * x[j];
        }
    }
    return value;
}

static void laws_that_are_not_there_err_by_nothing(void)
{
    double worth = 1.0;
    const double x[COLUMNS] = {1e-4, -2e-4};
    TEST_ASSERT_TRUE(tolerance_sum(&data, &state, blocks, column, COLUMNS, sums, &worth, NULL));
    SAME(0.0, worth);
    SAME(form(&blocks[0], x) + form(&blocks[1], x), form(sums, x));
}

/* The least over one error a point, of standard deviation `deviation` along R, at any x. */
static double least_over_errors(const double x[COLUMNS], double deviation, double *taken)
{
    double all = 0.0;
    *taken = 0.0;
    for (size_t k = 0; k < POINTS; k++) {
        const gram *b = &blocks[k];
        const double slope = b->g[0] + b->h[0][0] * x[0] + b->h[0][1] * x[1];
        const double shift = -slope / (b->h[0][0] + 1.0 / (deviation * deviation));
        const double moved[COLUMNS] = {x[0] + shift, x[1]};
        all += form(b, moved) + shift * shift / (deviation * deviation);
        /* At the state: how far the error lowers the objective, less what a free number does by itself. */
        const double at_state = -b->g[0] / (b->h[0][0] + 1.0 / (deviation * deviation));
        *taken += -b->g[0] * at_state - log(1.0 + b->h[0][0] * deviation * deviation);
    }
    return all;
}

static void each_operating_point_may_err_by_its_share(void)
{
    double worth = 0.0;
    double taken = 0.0;
    double scatter[CAUSE_COUNT] = {0.0};
    const double share = law_holds_to[CAUSE_RESISTANCE];
    TEST_ASSERT_TRUE(share > 0.0);
    state.set = BIT(H_RESISTANCE);
    state.z[P_R] = 0.05;
    TEST_ASSERT_TRUE(tolerance_sum(&data, &state, blocks, column, COLUMNS, sums, &worth, scatter));
    for (int n = -3; n <= 3; n++) {
        const double x[COLUMNS] = {1e-4 * n, -2e-4 * n * n};
        SAME(least_over_errors(x, 0.05 * share, &taken), form(sums, x));
    }
    SAME(taken, worth);
    /* The two points put R at 1.25e-4 and -1.75e-4 of the file's off the state's 0.05: 0.3 % rms of it, less noise. */
    const double noise = 1.0 / (4e8 * 0.05 * 0.05);
    SAME(sqrt(0.5 * (2.5e-3 * 2.5e-3 + 3.5e-3 * 3.5e-3) - noise), scatter[CAUSE_RESISTANCE]);
    SAME(0.0, scatter[CAUSE_FLUX_LINKAGE]);
}

/* A flux that acts at one point only, as R does there, takes up what R's law leaves: it gains less than a free number costs. */
static void what_takes_up_what_a_law_leaves_gains_nothing(void)
{
    double worth = 0.0;
    memset(blocks, 0, POINTS * sizeof *blocks);
    blocks[0].group = 0;
    blocks[1].group = 1;
    const double off = 0.05 * 0.004; /* of R, at the one point */
    for (size_t i = 0; i < COLUMNS; i++) {
        for (size_t j = 0; j < COLUMNS; j++) {
            blocks[0].h[i][j] = 4e9;
        }
        blocks[0].g[i] = -4e9 * off;
    }
    blocks[1].h[0][0] = 4e9;
    state.set = BIT(H_RESISTANCE);
    state.z[P_R] = 0.05;
    const double plain = blocks[0].g[1] * blocks[0].g[1] / blocks[0].h[1][1];
    TEST_ASSERT_TRUE(plain > 100.0);
    TEST_ASSERT_TRUE(tolerance_sum(&data, &state, blocks, column, COLUMNS, sums, &worth, NULL));
    TEST_ASSERT_TRUE(sums->g[1] * sums->g[1] / sums->h[1][1] < 1.0);
}

static void what_shapes_a_law_may_differ_between_points(void)
{
    double worth = 0.0;
    const int shapes[COLUMNS] = {P_KNEE, P_PSI};
    TEST_ASSERT_TRUE(coordinate_table[P_KNEE].wanders > 0.0);
    state.set = BIT(H_DEAD_TIME);
    state.z[P_V_DEAD] = 0.05;
    TEST_ASSERT_TRUE(tolerance_sum(&data, &state, blocks, shapes, COLUMNS, sums, &worth, NULL));
    for (int n = -2; n <= 2; n++) {
        double taken = 0.0;
        const double x[COLUMNS] = {3e-4 * n, 1e-4 * n};
        SAME(least_over_errors(x, coordinate_table[P_KNEE].wanders, &taken), form(sums, x));
        SAME(taken, worth);
    }
}

/* Laws of columns that do not touch: what all are worth together is the sum of what each is alone, up to sixteen of them. */
static void laws_that_do_not_touch_are_worth_their_sum(void)
{
    const hypothesis_id law[] = {H_RESISTANCE,       H_FLUX,        H_VOLTAGE_GAIN, H_CURRENT_OFFSET,
                                 H_ANGLE_OFFSET,     H_ANGLE_DELAY, H_SENSOR_LAG,   H_EMF_HARMONICS_11,
                                 H_ANGLE_HARMONIC_1, H_ASYMMETRY_A, H_INDUCTANCE_B};
    enum { LAWS = sizeof law / sizeof *law };
    int columns[LAWS];
    double wanted = 0.0;
    memset(blocks, 0, POINTS * sizeof *blocks);
    blocks[1].group = 1;
    for (size_t k = 0; k < LAWS; k++) {
        const double deviation = 0.1 * law_holds_to[hypothesis_table[law[k]].cause];
        TEST_ASSERT_TRUE(deviation > 0.0);
        columns[k] = hypothesis_table[law[k]].column[0];
        state.set |= BIT(law[k]);
        state.z[columns[k]] = 0.1;
        blocks[0].h[k][k] = 1e8 * (double)(k + 1);
        blocks[0].g[k] = 1e5;
        const double stiff = blocks[0].h[k][k] + 1.0 / (deviation * deviation);
        wanted += 1e10 / stiff - log(1.0 + blocks[0].h[k][k] * deviation * deviation);
    }
    double worth = 0.0;
    TEST_ASSERT_TRUE(tolerance_sum(&data, &state, blocks, columns, LAWS, sums, &worth, NULL));
    SAME(wanted, worth);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(laws_that_are_not_there_err_by_nothing);
    RUN_TEST(each_operating_point_may_err_by_its_share);
    RUN_TEST(what_takes_up_what_a_law_leaves_gains_nothing);
    RUN_TEST(what_shapes_a_law_may_differ_between_points);
    RUN_TEST(laws_that_do_not_touch_are_worth_their_sum);
    return UNITY_END();
}

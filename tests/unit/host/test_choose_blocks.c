/*
 * What the diagnosis makes of blocks' sums (sim_host/diagnose/choose): how wide an interval is, and what a view of them
 * holds. The sums are made by hand: the program is linked so that those of a recording are never asked for.
 */
#include "choose_fixture.h"
#include "diagnose/weigh/certainty.h"
#include "diagnose/weigh/tolerance.h"

enum { MOST_BLOCKS = 60 };

/* Of each block: how steep by a column; of all alike: how curved. */
static double steep[MOST_BLOCKS][COLUMN_COUNT];
static double curved[COLUMN_COUNT][COLUMN_COUNT];
static size_t group_of[MOST_BLOCKS];
static bool asked[COLUMN_COUNT];
static bool no_memory;

gram *__wrap_gram_blocks(fit_data *d, const fit_state *s, const int *column, size_t n);

gram *__wrap_gram_blocks(fit_data *d, const fit_state *s, const int *column, size_t n)
{
    (void)s;
    gram *made = no_memory ? NULL : calloc(d->blocks, sizeof *made);
    for (size_t i = 0; i < n; i++) {
        asked[column[i]] = true;
    }
    for (size_t b = 0; made && b < d->blocks; b++) {
        made[b].group = group_of[b];
        made[b].c = 100.0;
        for (size_t i = 0; i < n; i++) {
            made[b].g[i] = steep[b][column[i]];
            for (size_t j = 0; j < n; j++) {
                made[b].h[i][j] = curved[column[i]][column[j]];
            }
        }
    }
    return made;
}

static coordinate_frame frame;

static fit_data blocks_of(size_t blocks, size_t groups)
{
    rows.sensors = SENSORS_TWO; /* no common offset */
    rows.groups = groups;
    frame = (coordinate_frame){.of_least = 0.5};
    no_memory = false;
    for (size_t b = 0; b < MOST_BLOCKS; b++) {
        group_of[b] = b % groups;
    }
    for (size_t i = 0; i < COLUMN_COUNT; i++) {
        asked[i] = false;
        for (size_t b = 0; b < MOST_BLOCKS; b++) {
            steep[b][i] = 0.0;
        }
        for (size_t j = 0; j < COLUMN_COUNT; j++) {
            curved[i][j] = 0.0;
        }
    }
    return (fit_data){.rows = &rows, .frame = &frame, .blocks = blocks};
}

/* ---- Widths ---- */

#define CURVED 2e6 /* of R, each block's: a deviation of 1/1414 by one block */

static certainty sure_of_resistance(fit_data *d)
{
    certainty c;
    curved[P_R][P_R] = CURVED;
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_TRUE(certainty_of(d, &state, &c));
    TEST_ASSERT_EQUAL_INT(P_R, c.column[0]);
    return c;
}

static void quiet_blocks_leave_what_the_information_says(void)
{
    fit_data d = blocks_of(8, 2);
    const certainty c = sure_of_resistance(&d);
    SAME(1.96 / sqrt(8.0 * CURVED), c.half_width[0]);
    SAME(0.0, c.covariance[0][0]);
    SAME(1.0, c.inflation);
}

/* Each block pulls at R as hard, half of them one way: a step of pull / (n h) each, n of them squared. */
static double by_blocks(size_t blocks, double pull)
{
    const double step = pull / ((double)blocks * CURVED);
    return (double)blocks * step * step;
}

static void pull_at_resistance(size_t blocks, double pull)
{
    for (size_t b = 0; b < blocks; b++) {
        steep[b][P_R] = b < blocks / 2 ? pull : -pull;
    }
}

/* Student's t of 97.5 %. */
static const double of_degrees[] = {
    [2] = 4.303, [3] = 3.182,  [4] = 2.776,  [5] = 2.571,  [6] = 2.447,  [7] = 2.365,  [8] = 2.306,
    [9] = 2.262, [10] = 2.228, [11] = 2.201, [12] = 2.179, [13] = 2.160, [14] = 2.145, [15] = 2.131};

static void scores_of_blocks_widen(void)
{
    const double pull = 1e5;
    for (size_t blocks = 3; blocks <= 16; blocks++) {
        fit_data d = blocks_of(blocks, 2);
        pull_at_resistance(blocks, pull);
        const certainty c = sure_of_resistance(&d);
        const size_t degrees = blocks - 1;
        const double variance = by_blocks(blocks, pull) * (double)blocks / (double)degrees;
        const double wanted = of_degrees[degrees] * sqrt(variance);
        SAME(variance, c.covariance[0][0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.002 * wanted, wanted, c.half_width[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * c.inflation, variance * (double)blocks * CURVED, c.inflation);
        TEST_ASSERT_TRUE(c.inflation > 100.0);
    }
}

/* Of two blocks and one member no scatter is known: as of two degrees, and twice the variance. Of three it is. */
static void few_blocks_are_said_to_be_few(void)
{
    fit_data d = blocks_of(2, 2);
    pull_at_resistance(2, 1e5);
    certainty c = sure_of_resistance(&d);
    SAME(2.0 * by_blocks(2, 1e5), c.covariance[0][0]);
    SAME(4.303 * sqrt(c.covariance[0][0]), c.half_width[0]);
    d = blocks_of(3, 3);
    pull_at_resistance(3, 1e5);
    c = sure_of_resistance(&d);
    SAME(1.5 * by_blocks(3, 1e5), c.covariance[0][0]);
    SAME(4.303 * sqrt(c.covariance[0][0]), c.half_width[0]);
    d = blocks_of(4, 2); /* of two members */
    pull_at_resistance(4, 1e5);
    curved[P_R][P_R] = CURVED;
    curved[P_K_U][P_K_U] = CURVED;
    state.set = BIT(H_RESISTANCE) | BIT(H_VOLTAGE_GAIN);
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c));
    SAME(2.0 * by_blocks(4, 1e5), c.covariance[0][0]);
    SAME(4.303 * sqrt(c.covariance[0][0]), c.half_width[0]);
}

/* Where priors hold all members, the blocks' scatter lacks that of its mean alone. */
static void held_members_take_no_degrees(void)
{
    const double prior[COLUMN_COUNT][COLUMN_COUNT] = {{1e-6}, {0.0, 1e-6}};
    fit_data d = blocks_of(4, 2);
    certainty c = {.columns = 2, .column = {P_R, P_K_U}, .inflation = 1.0};
    pull_at_resistance(4, 1e5);
    curved[P_R][P_R] = CURVED;
    curved[P_K_U][P_K_U] = CURVED;
    state.set = BIT(H_RESISTANCE) | BIT(H_VOLTAGE_GAIN);
    TEST_ASSERT_TRUE(certainty_under(&d, &state, prior, 2, 1, &c));
    SAME(4.0 / 3.0 * by_blocks(4, 1e5), c.covariance[0][0]);
    SAME(3.182 * sqrt(c.covariance[0][0]), c.half_width[0]);
}

/* Blocks of a point that pull alike count as one observation; three points or fewer are not asked. */
static void scores_of_operating_points_widen(void)
{
    const double pull = 1e5;
    for (size_t groups = 2; groups <= 13; groups++) {
        const size_t blocks = 4 * groups;
        fit_data d = blocks_of(blocks, groups);
        for (size_t b = 0; b < blocks; b++) {
            steep[b][P_R] = group_of[b] % 2 == 0 ? pull : -pull;
        }
        const certainty c = sure_of_resistance(&d);
        const double step = 4.0 * pull / ((double)blocks * CURVED);
        const double variance = (double)groups * step * step * (double)groups / (double)(groups - 1);
        if (groups > 3) {
            const double wanted = of_degrees[groups - 1] * sqrt(variance);
            TEST_ASSERT_DOUBLE_WITHIN(0.002 * wanted, wanted, c.half_width[0]);
        } else {
            TEST_ASSERT_TRUE(c.half_width[0] < 2.4 * sqrt(c.covariance[0][0]));
        }
        /* The covariance is that of the blocks. */
        SAME(by_blocks(blocks, pull) * (double)blocks / (double)(blocks - 1), c.covariance[0][0]);
    }
}

/* What may move unnamed is as wide as its prior where the rows say nothing; and so are the scores of blocks and points. */
static void what_is_not_seen_is_as_wide_as_its_prior(void)
{
    fit_data d = blocks_of(12, 6);
    const certainty c = sure_of_resistance(&d);
    const double digits = coordinate_table[P_PSI].digits;
    TEST_ASSERT_TRUE(digits > 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, certainty_half_width(&c, P_V_DEAD)); /* a dead time does not */
    const double group = of_degrees[5] * digits * sqrt(6.0 / 5.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, digits * digits * 12.0 / 11.0, c.covariance[3][3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * group, group, certainty_half_width(&c, P_PSI));
    SAME(1.0, c.inflation); /* that is of the members alone */
}

/* Two members whose columns lean, and what a third score says of both: by the inverse of two by two. */
static void members_that_lean_are_as_sure_as_both_leave_them(void)
{
    fit_data d = blocks_of(40, 2);
    certainty c;
    const double a = 3e6;
    const double b = 1e6;
    const double e = 2e6;
    curved[P_R][P_R] = a;
    curved[P_R][P_K_U] = curved[P_K_U][P_R] = b;
    curved[P_K_U][P_K_U] = e;
    pull_at_resistance(40, 6e4);
    for (size_t k = 0; k < 40; k++) {
        steep[k][P_K_U] = 0.5 * steep[k][P_R];
    }
    state.set = BIT(H_RESISTANCE) | BIT(H_VOLTAGE_GAIN);
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c));
    const double whole = 40.0 * (a * e - b * b);
    const double steps[] = {6e4 * (e - 0.5 * b) / whole, 6e4 * (0.5 * a - b) / whole};
    const double information[] = {e / whole, a / whole};
    double ratio = 0.0;
    for (size_t i = 0; i < 2; i++) {
        for (size_t j = 0; j < 2; j++) {
            const double wanted = 40.0 * steps[i] * steps[j] * 40.0 / 38.0;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * fabs(wanted), wanted, c.covariance[i][j]);
        }
        ratio += 0.5 * c.covariance[i][i] / information[i];
    }
    TEST_ASSERT_TRUE(ratio > 2.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * ratio, ratio, c.inflation);
    /* Less scatter than white noise has does not count. */
    for (size_t k = 0; k < 40; k++) {
        steep[k][P_R] *= 1e-3;
        steep[k][P_K_U] *= 1e-3;
    }
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c));
    SAME(1.0, c.inflation);
}

static void indistinguishable_or_not_asked(void)
{
    fit_data d = blocks_of(8, 2);
    certainty c;
    curved[P_R][P_R] = curved[P_R][P_K_U] = curved[P_K_U][P_R] = curved[P_K_U][P_K_U] = CURVED;
    state.set = BIT(H_RESISTANCE) | BIT(H_VOLTAGE_GAIN);
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c));
    SAME(1e6, c.half_width[0]);
    SAME(1e6, c.half_width[1]);
    SAME(1e12, c.covariance[1][1]);
    SAME(0.0, c.covariance[0][1]);
    SAME(1.0, c.inflation);
    state.set = 0;
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c));
    SAME(1.0, c.inflation);
    no_memory = true;
    TEST_ASSERT_TRUE(certainty_of(&d, &state, &c)); /* nothing was asked for */
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_FALSE(certainty_of(&d, &state, &c));
}

/* ---- A view ---- */

static void a_view_looks_at_what_is_allowed_and_at_what_stands(void)
{
    fit_data d = blocks_of(4, 2);
    state.set = BIT(H_DEAD_TIME);
    state.edge = EDGE_CHARGED;
    TEST_ASSERT_TRUE(evidence_look(&d, &state, BIT(H_INDUCTANCE) | BIT(H_GAIN_MISMATCH), view));
    TEST_ASSERT_TRUE(asked[COLUMN_L] && asked[P_L_D] && asked[P_L_Q]);
    TEST_ASSERT_TRUE(asked[P_V_DEAD] && asked[P_KNEE] && asked[P_RIPPLE]);
    TEST_ASSERT_TRUE(asked[P_PSI] && asked[P_R] && asked[P_GAIN_A]); /* within the parameter tolerance */
    TEST_ASSERT_FALSE(asked[P_IRON]);                                /* iron has none */
    TEST_ASSERT_FALSE(asked[P_COMPENSATION_KNEE]);                   /* of another hypothesis */
    TEST_ASSERT_FALSE(asked[P_GAIN_C] || asked[P_OFFSET_ZERO]);      /* of a third sensor */
    rows.sensors = SENSORS_THREE;
    state.edge = EDGE_CLIPPED;
    state.set = 0;
    TEST_ASSERT_TRUE(evidence_look(&d, &state, BIT(H_COMPENSATED), view));
    TEST_ASSERT_FALSE(asked[P_COMPENSATION_KNEE]); /* not in the set */
    state.set = BIT(H_COMPENSATED);
    TEST_ASSERT_TRUE(evidence_look(&d, &state, 0, view));
    TEST_ASSERT_TRUE(asked[P_COMPENSATION_KNEE] && asked[P_GAIN_C] && asked[P_OFFSET_ZERO]);
}

static void a_view_holds_the_blocks_sums_and_the_way_back(void)
{
    fit_data d = blocks_of(6, 2);
    rows.sensors = SENSORS_THREE;
    curved[P_R][P_R] = 5.0;
    curved[P_R][COLUMN_L] = curved[COLUMN_L][P_R] = 2.0;
    curved[COLUMN_L][COLUMN_L] = 3.0;
    for (size_t b = 0; b < 6; b++) {
        steep[b][P_R] = 1.0 + (double)b;
    }
    state.edge = EDGE_CLIPPED;
    state.set = BIT(H_DEAD_TIME);
    state.z[P_R] = 0.3;
    state.z[P_KNEE] = 0.2;
    state.z[P_OFFSET_ZERO] = 0.1;
    const double digits = coordinate_table[P_R].digits;
    TEST_ASSERT_TRUE(evidence_look(&d, &state, BIT(H_RESISTANCE) | BIT(H_INDUCTANCE), view));
    SAME(600.0, view->sums.c);
    SAME(21.0, view->sums.g[P_R]);
    SAME(30.0, view->sums.h[P_R][P_R]);
    SAME(12.0, view->sums.h[P_R][COLUMN_L]);
    SAME(18.0, view->sums.h[COLUMN_L][COLUMN_L]);
    SAME(30.0 / (1.0 + 30.0 * digits * digits), view->total.h[P_R][P_R]);
    SAME(0.5, view->of_least);
    TEST_ASSERT_EQUAL_INT(EDGE_CLIPPED, view->edge);
    TEST_ASSERT_TRUE(view->rows == &rows);
    SAME(-0.3, view->to_nominal[P_R]);
    SAME(0.0, view->to_nominal[P_KNEE]); /* what shapes a law, and the common offset, stay where they are */
    SAME(0.0, view->to_nominal[P_OFFSET_ZERO]);
    SAME(0.0, view->to_nominal[COLUMN_L]);
    SAME(0.0, view->explained);
}

/* For fewer hypotheses, of the same state, nothing is summed again. */
static void a_view_that_stands_is_not_made_again(void)
{
    fit_data d = blocks_of(4, 2);
    const hypothesis_set both = BIT(H_RESISTANCE) | BIT(H_INDUCTANCE);
    curved[P_R][P_R] = 5.0;
    view->stands = false;
    TEST_ASSERT_TRUE(evidence_look(&d, &state, both, view));
    view->explained = view->least = 7.0;
    no_memory = true;
    TEST_ASSERT_TRUE(evidence_look(&d, &state, BIT(H_RESISTANCE), view));
    SAME(20.0, view->sums.h[P_R][P_R]);
    SAME(0.0, view->explained + view->least); /* what a search has set */
    no_memory = false;
    for (int change = 0; change < 6; change++) {
        TEST_ASSERT_TRUE(evidence_look(&d, &state, both, view));
        const fit_state before = state;
        hypothesis_set allowed = both;
        state.z[P_PSI] += change == 0 ? 1e-9 : 0.0;
        state.noise[1].gain += change == 1 ? 1e-9 : 0.0;
        state.edge = change == 2 ? (state.edge == EDGE_CHARGED ? EDGE_CLIPPED : EDGE_CHARGED) : state.edge;
        state.set ^= change == 3 ? BIT(H_INDUCTANCE) : 0;
        allowed |= change == 4 ? BIT(H_DEAD_TIME) : 0;
        view->stands = change != 5; /* rows have changed */
        no_memory = true;
        TEST_ASSERT_FALSE(evidence_look(&d, &state, allowed, view));
        TEST_ASSERT_FALSE(view->stands);
        no_memory = false;
        state = before;
    }
}

/* What a state's laws may err by, of its own columns alone. */
static void a_states_worth_is_that_of_its_points(void)
{
    fit_data d = blocks_of(4, 2);
    double worth = 0.0;
    curved[P_R][P_R] = 1e8;
    for (size_t b = 0; b < 4; b++) {
        steep[b][P_R] = group_of[b] == 0 ? 4e4 : -6e4;
    }
    state.set = BIT(H_RESISTANCE);
    state.z[P_R] = 0.05;
    const double deviation = 0.05 * law_holds_to[CAUSE_RESISTANCE];
    const double stiff = 2e8 + 1.0 / (deviation * deviation);
    const double wanted = (8e4 * 8e4 + 12e4 * 12e4) / stiff - 2.0 * log(1.0 + 2e8 * deviation * deviation);
    TEST_ASSERT_TRUE(tolerance_of_state(&d, &state, &worth));
    SAME(wanted, worth);
    no_memory = true;
    TEST_ASSERT_FALSE(tolerance_of_state(&d, &state, &worth));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(quiet_blocks_leave_what_the_information_says);
    RUN_TEST(scores_of_blocks_widen);
    RUN_TEST(few_blocks_are_said_to_be_few);
    RUN_TEST(held_members_take_no_degrees);
    RUN_TEST(scores_of_operating_points_widen);
    RUN_TEST(what_is_not_seen_is_as_wide_as_its_prior);
    RUN_TEST(members_that_lean_are_as_sure_as_both_leave_them);
    RUN_TEST(indistinguishable_or_not_asked);
    RUN_TEST(a_view_looks_at_what_is_allowed_and_at_what_stands);
    RUN_TEST(a_view_holds_the_blocks_sums_and_the_way_back);
    RUN_TEST(a_view_that_stands_is_not_made_again);
    RUN_TEST(a_states_worth_is_that_of_its_points);
    return UNITY_END();
}

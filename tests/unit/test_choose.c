/*
 * How the diagnosis decides (sim_host/diagnose/choose), on sums that are made by hand: which cost a set of hypotheses
 * leaves, what it pays, how small a cause may be beside others, what could take its place, how probable it is, how
 * sure. No recording: a parabola along each coordinate says all that the rules ask of one.
 */
#include "diagnose/choose/borne_out.h"
#include "diagnose/choose/certainty.h"
#include "diagnose/choose/confusion.h"
#include "diagnose/choose/estimates.h"
#include "diagnose/choose/evidence.h"
#include "diagnose/choose/probability.h"
#include "diagnose/identify/last_digits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static diagnose_rows rows;
static evidence_view *view;
static fit_state state;

#define WORST      1000.0
#define BIT        HYPOTHESIS_BIT
#define WITHIN(x)  (1e-9 * (1.0 + fabs(x)))
#define SAME(a, b) TEST_ASSERT_DOUBLE_WITHIN(WITHIN(a), a, b)

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
static void parabola(int column, double best, double less)
{
    const double curve = less / (best * best);
    view->total.h[column][column] = view->sums.h[column][column] = curve;
    view->total.g[column] = view->sums.g[column] = -curve * best;
}

static evidence_option of(hypothesis_set set)
{
    evidence_option option;
    TEST_ASSERT_TRUE(evidence_cost(view, &state, set, &option));
    return option;
}

/* ---- The cost of a set ---- */

static void a_set_leaves_what_its_columns_cannot_take(void)
{
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, -0.02, 300.0);
    SAME(WORST, of(0).cost);
    SAME(WORST - 600.0, of(BIT(H_RESISTANCE)).cost);
    const evidence_option both = of(BIT(H_RESISTANCE) | BIT(H_FLUX));
    SAME(WORST - 900.0, both.cost);
    SAME(0.05, both.z[P_R]);
    SAME(-0.02, both.z[P_PSI]);
    SAME(both.cost + evidence_penalty(view, both.set) + hypotheses_unusual(both.set, both.z), both.score);
    TEST_ASSERT_TRUE(hypotheses_unusual(both.set, both.z) > 0.0);
    TEST_ASSERT_TRUE(both.set == (BIT(H_RESISTANCE) | BIT(H_FLUX)));
}

/* Two columns that lean on one another: the minimum of 100 (x - 1)^2 + 100 (y - 1)^2 + 2 60 (x - 1)(y - 1), in hundredths. */
static void columns_that_lean_are_solved_together(void)
{
    const double at = 0.1;
    const double c = 1e4;
    const double lean = 6e3;
    view->total.h[P_R][P_R] = view->total.h[P_PSI][P_PSI] = c;
    view->total.h[P_R][P_PSI] = view->total.h[P_PSI][P_R] = lean;
    view->total.g[P_R] = view->total.g[P_PSI] = -(c + lean) * at;
    const evidence_option both = of(BIT(H_RESISTANCE) | BIT(H_FLUX));
    SAME(at, both.z[P_R]);
    SAME(at, both.z[P_PSI]);
    SAME(WORST - 2.0 * (c + lean) * at * at, both.cost);
    const evidence_option one = of(BIT(H_RESISTANCE));
    SAME((c + lean) * at / c, one.z[P_R]);
    SAME(WORST - (c + lean) * (c + lean) * at * at / c, one.cost);
}

/* From a state that holds causes already, a set without them goes all the way back. */
static void a_set_is_weighed_from_wherever_the_state_stands(void)
{
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, -0.02, 300.0);
    const double z = 0.03;
    const double curve = view->total.h[P_R][P_R];
    view->total.c = WORST - 600.0 + curve * (0.05 - z) * (0.05 - z);
    view->total.g[P_R] = -curve * (0.05 - z);
    view->to_nominal[P_R] = -z;
    state.z[P_R] = z;
    state.set = BIT(H_RESISTANCE);
    SAME(WORST, of(0).cost);
    SAME(WORST - 300.0, of(BIT(H_FLUX)).cost);
    const evidence_option own = of(BIT(H_RESISTANCE));
    SAME(WORST - 600.0, own.cost);
    SAME(0.05, own.z[P_R]);
    SAME(0.0, of(BIT(H_FLUX)).z[P_R]);
}

/* A cycle's delay is not fitted: the coordinate is 1 or it is not. */
static void what_is_fixed_is_not_fitted(void)
{
    parabola(P_U_DELAY_1, 0.9, 810.0);
    const evidence_option whole = of(BIT(H_VOLTAGE_DELAY_1));
    SAME(1.0, whole.z[P_U_DELAY_1]);
    SAME(WORST - 810.0 + 1000.0 * 0.01, whole.cost);
}

/* The sensors' common offset is none of the causes, and is always fitted where it shows. */
static void the_common_offset_is_always_free(void)
{
    parabola(P_R, 0.05, 600.0);
    parabola(P_OFFSET_ZERO, 0.01, 100.0);
    SAME(WORST - 700.0, of(BIT(H_RESISTANCE)).cost);
    SAME(WORST - 100.0, of(0).cost);
}

static void what_is_no_choice_is_refused(void)
{
    evidence_option option;
    parabola(P_R, 0.5 * hypothesis_table[H_RESISTANCE].least, 600.0);
    TEST_ASSERT_FALSE(evidence_cost(view, &state, BIT(H_RESISTANCE), &option)); /* too small for a name */
    view->of_least = 0.0;
    TEST_ASSERT_TRUE(evidence_cost(view, &state, BIT(H_RESISTANCE), &option));
    view->of_least = 1.0;
    TEST_ASSERT_TRUE((hypothesis_table[H_IRON_LOSS].positive & SIGN_FIRST) != 0);
    parabola(P_FE, -1.0, 600.0);
    TEST_ASSERT_FALSE(evidence_cost(view, &state, BIT(H_IRON_LOSS), &option)); /* of the wrong sign */
    parabola(P_FE, 1.0, 600.0);
    TEST_ASSERT_TRUE(evidence_cost(view, &state, BIT(H_IRON_LOSS), &option));
    /* Not told apart: without a step, and last in every list. */
    view->total.h[P_R][P_R] = view->total.h[P_PSI][P_PSI] = view->total.h[P_R][P_PSI] =
        view->total.h[P_PSI][P_R] = 1e4;
    TEST_ASSERT_FALSE(evidence_cost(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), &option));
    SAME(WORST, option.cost);
    TEST_ASSERT_TRUE(isinf(option.score));
}

/* ---- What it pays, and how small it may be ---- */

static void a_set_pays_for_causes_parameters_and_surprise(void)
{
    SAME(0.0, evidence_penalty(view, 0));
    SAME(25.0 + 12.0, evidence_penalty(view, BIT(H_RESISTANCE)));
    SAME(2.0 * (25.0 + 12.0) + 1.0, evidence_penalty(view, BIT(H_FLUX) | BIT(H_VOLTAGE_GAIN)));
    SAME(25.0 + 12.0 * 3.0, evidence_penalty(view, BIT(H_DEAD_TIME))); /* what shapes its law counts */
    SAME(25.0 + 12.0 * 3.0 + 4.0, evidence_penalty(view, BIT(H_CURRENT_GAIN)));
    rows.two_sensors = true;
    SAME(25.0 + 12.0 * 2.0 + 4.0, evidence_penalty(view, BIT(H_CURRENT_GAIN)));
    rows.two_sensors = false;
    /* Beside a map a share of what is explained, or what the last search was told, whichever is more; the latter for a
     * name. */
    view->explained = 1e6;
    SAME(37.0, evidence_penalty(view, BIT(H_RESISTANCE)));
    const double with_map = evidence_penalty(view, BIT(H_RESISTANCE) | BIT(H_MAP));
    view->explained = 0.0;
    SAME(1e4, with_map - evidence_penalty(view, BIT(H_RESISTANCE) | BIT(H_MAP)));
    view->least = 150.0;
    SAME(37.0 + 150.0, evidence_penalty(view, BIT(H_RESISTANCE)));
    TEST_ASSERT_FALSE(hypothesis_cause(H_SENSOR_ZONE)->named);
    SAME(25.0 + 12.0 + 6.0, evidence_penalty(view, BIT(H_SENSOR_ZONE)));
}

static void the_least_beside_what_leaves_more_than_a_tolerance(void)
{
    SAME(0.0, evidence_least(1.0, BIT(H_RESISTANCE) | BIT(H_DEAD_TIME), H_RESISTANCE));
    SAME(3e-2, evidence_least(1.0, BIT(H_SENSOR_LAG) | BIT(H_DEAD_TIME), H_SENSOR_LAG));
    SAME(0.0, evidence_least(1.0, BIT(H_SENSOR_LAG), H_SENSOR_LAG));
    SAME(3e-2, evidence_least(3.0, BIT(H_RESISTANCE) | BIT(H_MAP), H_RESISTANCE));
    SAME(0.0, evidence_least(1.0, BIT(H_RESISTANCE) | BIT(H_MAP), H_MAP));
}

static void a_set_in_words(void)
{
    char text[64];
    TEST_ASSERT_EQUAL_STRING("nothing", evidence_words(0, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("resistance", evidence_words(BIT(H_RESISTANCE), text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(
        "resistance + flux_linkage + dead_time",
        evidence_words(BIT(H_DEAD_TIME) | BIT(H_FLUX) | BIT(H_RESISTANCE), text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("resista",
                             evidence_words(BIT(H_RESISTANCE) | BIT(H_FLUX), text, 8)); /* cut, no more */
}

/* ---- What else it could be ---- */

/* R takes 600. psi takes as much but for `worse`. */
static void make_rivals(double worse)
{
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, 0.05, 600.0 - worse);
    state.set = BIT(H_RESISTANCE);
}

static bool rivals(double inflation)
{
    return confusion_of(view, &state, of(state.set).cost, H_RESISTANCE, H_FLUX, inflation);
}

static void another_is_as_good_within_fifteen(void)
{
    make_rivals(14.9);
    TEST_ASSERT_TRUE(rivals(1.0));
    make_rivals(15.1);
    TEST_ASSERT_FALSE(rivals(1.0));
    TEST_ASSERT_TRUE(rivals(1.1)); /* of noisier scores */
    const double own = of(state.set).cost;
    make_rivals(-100.0);
    TEST_ASSERT_TRUE(rivals(1.0)); /* better is as good, too */
    /* Its own cause in another form, what holds it by construction, and what has no name. */
    parabola(P_R_RATE, 0.05, 600.0);
    parabola(P_ZONE, 0.05, 600.0);
    view->of_least = 0.0;
    TEST_ASSERT_FALSE(confusion_of(view, &state, own, H_RESISTANCE, H_RESISTANCE, 1.0));
    TEST_ASSERT_FALSE(confusion_of(view, &state, own, H_RESISTANCE, H_RESISTANCE_DRIFTS, 1.0));
    TEST_ASSERT_FALSE(confusion_of(view, &state, own, H_RESISTANCE, H_SENSOR_ZONE, 1.0));
}

static void all_rivals_are_listed_once(void)
{
    diagnosis d = {.causes = 1};
    const hypothesis_id member[] = {H_RESISTANCE};
    make_rivals(5.0);
    parabola(P_THETA_0, 0.05, 599.0);
    parabola(P_K_U, 0.05, 100.0);
    confusion_find(&d, view, &state, member,
                   BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_ANGLE_OFFSET) | BIT(H_VOLTAGE_GAIN), 1.0);
    TEST_ASSERT_EQUAL_size_t(2, d.cause[0].confused);
    TEST_ASSERT_EQUAL_STRING("flux_linkage", d.cause[0].confused_with[0]);
    TEST_ASSERT_EQUAL_STRING("angle_offset", d.cause[0].confused_with[1]);
    confusion_find(&d, view, &state, member, BIT(H_RESISTANCE) | BIT(H_ANGLE_OFFSET),
                   1.0); /* what is not possible is not looked at */
    TEST_ASSERT_EQUAL_size_t(1, d.cause[0].confused);
    TEST_ASSERT_EQUAL_STRING("angle_offset", d.cause[0].confused_with[0]);
}

/* An inductance's 600 taken by a voltage gain and a flux together, and by neither alone. */
static void two_that_trade_for_one(void)
{
    diagnosis d = {.causes = 1};
    const hypothesis_id member[] = {H_INDUCTANCE};
    const hypothesis_set possible =
        BIT(H_INDUCTANCE) | BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_VOLTAGE_GAIN) | BIT(H_ANGLE_OFFSET);
    view->total.h[COLUMN_L][COLUMN_L] = 6e4;
    view->total.g[COLUMN_L] = -6e3;
    parabola(P_K_U, 0.1, 300.0);
    parabola(P_PSI, 0.1, 299.0);
    parabola(P_R, 0.1, 1.0);
    parabola(P_THETA_0, 0.1, 600.0); /* scales nothing */
    state.set = BIT(H_INDUCTANCE);
    confusion_trades(&d, view, &state, member, possible, 1.0);
    TEST_ASSERT_EQUAL_size_t(2, d.cause[0].trades);
    TEST_ASSERT_EQUAL_STRING("flux_linkage", d.cause[0].trade[0]);
    TEST_ASSERT_EQUAL_STRING("voltage_gain", d.cause[0].trade[1]);
    parabola(P_PSI, 0.1, 284.5); /* R's part is wanted as well */
    confusion_trades(&d, view, &state, member, possible, 1.0);
    TEST_ASSERT_EQUAL_size_t(3, d.cause[0].trades);
    TEST_ASSERT_EQUAL_STRING("resistance", d.cause[0].trade[0]);
    parabola(P_PSI, 0.1, 280.0);
    confusion_trades(&d, view, &state, member, possible, 1.0);
    TEST_ASSERT_EQUAL_size_t(0, d.cause[0].trades);
    confusion_trades(&d, view, &state, member, possible, 2.0);
    TEST_ASSERT_EQUAL_size_t(2, d.cause[0].trades);
}

/* ---- How probable, and how sure ---- */

/* Two that explain nearly the same, one better by a little: both together gain nothing, and either stands for the other. */
static void the_probability_is_a_share_of_the_evidence(void)
{
    standing of_all[H_COUNT];
    const hypothesis_set possible = BIT(H_ASYMMETRY_A) | BIT(H_INDUCTANCE_B) | BIT(H_DEAD_TIME);
    const double inflation = 1.5;
    parabola(P_DR_A, 0.05, 160.0);
    parabola(P_DL_B, 0.05, 158.0);
    view->total.h[P_DR_A][P_DL_B] = view->total.h[P_DR_A][P_DR_A] * 158.0 / 160.0;
    view->total.h[P_DL_B][P_DR_A] = view->total.h[P_DR_A][P_DL_B];
    view->sums = view->total;
    parabola(P_V_DEAD, 0.05, 1.0);
    state.set = BIT(H_ASYMMETRY_A);
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, inflation, of_all));
    const double other =
        exp(-0.5 * (of(BIT(H_INDUCTANCE_B)).score - of(BIT(H_ASYMMETRY_A)).score) / inflation);
    TEST_ASSERT_TRUE(other > 0.1 && other < 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.0 / (1.0 + other), of_all[H_ASYMMETRY_A].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, other / (1.0 + other), of_all[H_INDUCTANCE_B].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, other, of_all[H_ASYMMETRY_A].rival);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, of_all[H_INDUCTANCE_B].rival);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, of_all[H_DEAD_TIME].probability);
    SAME(of_all[H_ASYMMETRY_A].probability, of_all[H_ASYMMETRY_B].probability); /* a cause's are alike */
    SAME(0.0, of_all[H_VOLTAGE_GAIN].probability);
    /* Noisier scores say less. */
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, 3.0 * inflation, of_all));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0 / (1.0 + cbrt(other)), of_all[H_ASYMMETRY_A].probability);
}

/* What the file's last digits could take of a resistance says nothing against it once it is beyond its least. */
static void a_set_without_a_member_is_weighed_with_its_last_digits_held(void)
{
    standing of_all[H_COUNT];
    const double digits = coordinate_table[P_R].digits;
    const double curve = 100.0 / (digits * digits);
    TEST_ASSERT_TRUE(digits > 0.0);
    parabola(P_R, 0.03, curve * 9e-4);
    last_digits_deflate(&rows, NULL, &view->total); /* a hundred and first of it is left */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * curve, curve / 101.0, view->total.h[P_R][P_R]);
    evidence_view *held = calloc(1, sizeof *held);
    TEST_ASSERT_NOT_NULL(held);
    evidence_hold(view, H_RESISTANCE, held);
    SAME(curve, held->total.h[P_R][P_R]);
    evidence_hold(view, H_FLUX, held);
    SAME(view->total.h[P_R][P_R], held->total.h[P_R][P_R]);
    free(held);
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_TRUE(probability_of(view, &state, BIT(H_RESISTANCE), 1.0, of_all));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, of_all[H_RESISTANCE].probability);
}

/* One that may well be there too: as probable as the set that holds both is beside the set that was chosen. */
static void the_set_with_one_more_counts(void)
{
    standing of_all[H_COUNT];
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, 0.02, 36.0);
    state.set = BIT(H_RESISTANCE);
    const double more = exp(-0.5 * (of(BIT(H_RESISTANCE) | BIT(H_FLUX)).score - of(BIT(H_RESISTANCE)).score));
    TEST_ASSERT_TRUE(more > 0.3 && more < 1.0);
    probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, of_all);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, more / (1.0 + more), of_all[H_FLUX].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, of_all[H_RESISTANCE].probability);
}

/* What was fitted stands, though the parabola about it has its optimum where one of two that trade is too small for a name. */
static void the_set_that_was_fitted_counts_whatever_the_parabola_says(void)
{
    standing of_all[H_COUNT];
    evidence_option option;
    parabola(P_R, 0.9 * hypothesis_table[H_RESISTANCE].least, 600.0);
    parabola(P_PSI, 0.05, 550.0);
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_FALSE(evidence_cost(view, &state, state.set, &option));
    probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, of_all);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, of_all[H_RESISTANCE].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, of_all[H_FLUX].probability);
}

/* ---- Whether it explains as much as it leaves ---- */

/* Sensor noise alone is (1 - gain) of each of two components' variance; a gain of a tenth is as good as none. */
static void what_is_left_is_what_the_gain_says(void)
{
    const group_noise noise[] = {{.gain = 0.55, .rows = 1000.0}, {.gain = 0.1, .rows = 5000.0}};
    SAME(2.0 * 1000.0 * log(2.0), borne_out_left(noise, 1));
    SAME(2.0 * 1000.0 * log(2.0), borne_out_left(noise, 2));
    const group_noise trusted = {.gain = 0.03, .rows = 1000.0};
    SAME(0.0, borne_out_left(&trusted, 1));
}

static void a_set_explains_as_much_as_it_leaves(void)
{
    /* By the likelihood; of the power it takes next to nothing, and leaves 3. */
    TEST_ASSERT_TRUE(borne_out(1000.0, 1000.0, 2.0, 2.0, 1.0));
    TEST_ASSERT_FALSE(borne_out(999.0, 1000.0, 2.0, 2.0, 1.0));
    /* By the power: 9 is 4 of noise, 2 left, 3 explained. */
    TEST_ASSERT_TRUE(borne_out(1.0, 1000.0, 3.0, sqrt(6.0), 2.0));
    TEST_ASSERT_FALSE(borne_out(1.0, 1000.0, 3.0, sqrt(6.6), 2.0));
    /* A floor above the error leaves nothing. */
    TEST_ASSERT_TRUE(borne_out(1.0, 1000.0, 3.0, 2.5, 2.6));
    /* What makes the error worse explains nothing. */
    TEST_ASSERT_FALSE(borne_out(1.0, 1000.0, 3.0, 3.1, 2.0));
}

static certainty of_two(void)
{
    certainty c = {.columns = 2, .column = {P_R, P_PSI}, .half_width = {0.02, 0.03}};
    c.covariance[0][0] = 4.0;
    c.covariance[1][1] = 9.0;
    c.covariance[0][1] = c.covariance[1][0] = 3.0;
    return c;
}

static void what_is_asked_of_a_certainty(void)
{
    const certainty c = of_two();
    SAME(0.02, certainty_half_width(&c, P_R));
    SAME(0.03, certainty_half_width(&c, P_PSI));
    SAME(0.0, certainty_half_width(&c, P_K_U));
    SAME(0.5, certainty_correlation(&c, P_R, P_PSI));
    SAME(0.0, certainty_correlation(&c, P_K_U, P_PSI));
    SAME(0.0, certainty_correlation(&c, P_R, P_K_U));
    state.z[P_R] = 6.0;
    state.z[P_PSI] = -6.0;
    SAME(36.0 / 4.0, certainty_chi_square(&c, &state, H_RESISTANCE));
    SAME(36.0 / 9.0, certainty_chi_square(&c, &state, H_FLUX));
    SAME(0.0, certainty_chi_square(&c, &state, H_VOLTAGE_GAIN)); /* not fitted */
    TEST_ASSERT_TRUE(isinf(
        certainty_chi_square(&c, &state, H_VOLTAGE_DELAY_1))); /* nothing of it is fitted: it is, or is not */
}

/* Of two columns: z' C^-1 z with C = [4 3; 3 9]. */
static void a_cause_of_two_columns_is_weighed_with_both(void)
{
    certainty c = of_two();
    c.column[0] = P_OFFSET_A;
    c.column[1] = P_OFFSET_B;
    state.z[P_OFFSET_A] = 6.0;
    state.z[P_OFFSET_B] = -3.0;
    SAME((9.0 * 36.0 + 2.0 * 3.0 * 18.0 + 4.0 * 9.0) / 27.0,
         certainty_chi_square(&c, &state, H_CURRENT_OFFSET));
}

/* The size is the length of the vector (6, -3); along it a half width is that of the covariance's projection. */
static void a_size_is_as_sure_as_its_columns_together(void)
{
    certainty c = of_two();
    SAME(0.02, certainty_of_size(&c, &state, H_RESISTANCE));
    SAME(0.0, certainty_of_size(&c, &state, H_VOLTAGE_GAIN));
    c.column[0] = P_HARMONIC_1C;
    c.column[1] = P_HARMONIC_1S;
    state.z[P_HARMONIC_1C] = 6.0;
    state.z[P_HARMONIC_1S] = -3.0;
    const double a = 0.02 * 6.0 / sqrt(45.0);
    const double b = -0.03 * 3.0 / sqrt(45.0);
    const double expected = sqrt(a * a + b * b + 2.0 * 0.5 * a * b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * expected, expected, certainty_of_size(&c, &state, H_ANGLE_HARMONIC_1));
}

/* One coordinate set free, by the information of the sums: its step, and 1.96 standard deviations with a floor. */
static void an_estimate_is_of_the_information(void)
{
    const fit_data d = {.rows = &rows};
    const double usual = coordinate_table[P_R].usual;
    const double curve = 1e4 / (usual * usual);
    TEST_ASSERT_TRUE(usual > 0.0);
    view->sums.h[P_R][P_R] = curve;
    view->sums.g[P_R] = -0.3 * usual * curve;
    state.z[P_R] = 0.1 * usual;
    const estimate free_now = estimate_of(&d, view, &state, P_R, 4.0);
    TEST_ASSERT_TRUE(free_now.excited);
    SAME(0.4 * usual, free_now.z);
    SAME(1.96 * 2.0 / sqrt(curve) + 0.002 * usual, free_now.half_width);
    state.set = BIT(H_RESISTANCE); /* fitted already: what the fit says stands */
    SAME(0.1 * usual, estimate_of(&d, view, &state, P_R, 4.0).z);
    view->sums.h[P_R][P_R] = 0.9 / (usual * usual);
    TEST_ASSERT_FALSE(
        estimate_of(&d, view, &state, P_R, 1.0).excited); /* no better than drives show anyhow */
    view->sums.h[P_R][P_R] = 1.1 / (usual * usual);
    TEST_ASSERT_TRUE(estimate_of(&d, view, &state, P_R, 1.0).excited);
    view->sums.h[P_R][P_R] = 0.0;
    const estimate none = estimate_of(&d, view, &state, P_R, 1.0);
    TEST_ASSERT_TRUE(!none.excited && isinf(none.half_width));
    SAME(0.1 * usual, none.z);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_set_leaves_what_its_columns_cannot_take);
    RUN_TEST(columns_that_lean_are_solved_together);
    RUN_TEST(a_set_is_weighed_from_wherever_the_state_stands);
    RUN_TEST(what_is_fixed_is_not_fitted);
    RUN_TEST(the_common_offset_is_always_free);
    RUN_TEST(what_is_no_choice_is_refused);
    RUN_TEST(a_set_pays_for_causes_parameters_and_surprise);
    RUN_TEST(the_least_beside_what_leaves_more_than_a_tolerance);
    RUN_TEST(a_set_in_words);
    RUN_TEST(another_is_as_good_within_fifteen);
    RUN_TEST(all_rivals_are_listed_once);
    RUN_TEST(two_that_trade_for_one);
    RUN_TEST(the_probability_is_a_share_of_the_evidence);
    RUN_TEST(a_set_without_a_member_is_weighed_with_its_last_digits_held);
    RUN_TEST(the_set_with_one_more_counts);
    RUN_TEST(the_set_that_was_fitted_counts_whatever_the_parabola_says);
    RUN_TEST(what_is_left_is_what_the_gain_says);
    RUN_TEST(a_set_explains_as_much_as_it_leaves);
    RUN_TEST(what_is_asked_of_a_certainty);
    RUN_TEST(a_cause_of_two_columns_is_weighed_with_both);
    RUN_TEST(a_size_is_as_sure_as_its_columns_together);
    RUN_TEST(an_estimate_is_of_the_information);
    return UNITY_END();
}

/*
 * How the diagnosis decides (sim_host/diagnose/choose), on sums that are made by hand: which cost a set of hypotheses
 * leaves, what it pays, how small a cause may be next to others, what could take its place. No recording: a parabola
 * along each coordinate says all that the rules ask of one.
 */
#include "choose_fixture.h"
#include "diagnose/weigh/confusion.h"

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
    /* Not distinguishable: without a step, and last in every list. */
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
    SAME(25.0 + 12.0 * 4.0, evidence_penalty(view, BIT(H_DEAD_TIME))); /* what shapes its law counts */
    SAME(25.0 + 12.0 * 3.0 + 4.0, evidence_penalty(view, BIT(H_CURRENT_GAIN)));
    rows.sensors = SENSORS_TWO;
    SAME(25.0 + 12.0 * 2.0 + 4.0, evidence_penalty(view, BIT(H_CURRENT_GAIN)));
    rows.sensors = SENSORS_THREE;
    /* Next to a map a share of what is explained, or the last search's limit, whichever is more; the latter for a
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

static double more_than_a_cause_a_member(hypothesis_set set, const double z[P_COUNT])
{
    return evidence_price(view, set, z) - evidence_penalty(view, set) - hypotheses_unusual(set, z);
}

/* An inductance that falls with the current, and has the file's value nowhere. */
static void a_saturation_that_never_has_the_files_inductance_is_two_causes(void)
{
    const double least = hypothesis_table[H_INDUCTANCE].least;
    double z[P_COUNT] = {0.0};
    z[P_SATURATION] = expm1(5.0 * least);
    for (int k = -9; k <= 9; k++) {
        const double at_none = k * least + 0.01 * least;
        const double at_rated = at_none - 5.0 * least;
        const bool nowhere = (at_none > least && at_rated > least) || (at_none < -least && at_rated < -least);
        z[P_L_D] = z[P_L_Q] = at_none;
        SAME(nowhere ? 25.0 : 0.0, more_than_a_cause_a_member(BIT(H_SATURATION), z));
        SAME(0.0, more_than_a_cause_a_member(BIT(H_INDUCTANCE) | BIT(H_FALL), z)); /* two already */
    }
    /* Of any size: one that has the file's value at some current is one cause still. */
    view->of_least = 0.0;
    z[P_L_D] = z[P_L_Q] = 2.0 * least;
    SAME(0.0, more_than_a_cause_a_member(BIT(H_SATURATION), z));
}

/* What three sensors have in common, beyond what the mean of three errors is by chance. */
static void gains_in_common_are_a_cause_of_their_own(void)
{
    double z[P_COUNT] = {[P_GAIN_A] = 0.060, [P_GAIN_B] = 0.066, [P_GAIN_C] = 0.061};
    SAME(25.0, more_than_a_cause_a_member(BIT(H_CURRENT_GAIN), z));
    SAME(0.0, more_than_a_cause_a_member(BIT(H_GAIN_MISMATCH), z));
    z[P_GAIN_B] = -0.02; /* the mean is 0.75 of the deviation */
    SAME(0.0, more_than_a_cause_a_member(BIT(H_CURRENT_GAIN), z));
    z[P_GAIN_A] = z[P_GAIN_B] = z[P_GAIN_C] = 0.9 * hypothesis_table[H_CURRENT_GAIN].least;
    SAME(0.0, more_than_a_cause_a_member(BIT(H_CURRENT_GAIN), z));
}

static void the_least_next_to_a_residual_above_the_tolerance(void)
{
    SAME(0.0, evidence_least(1.0, BIT(H_RESISTANCE) | BIT(H_DEAD_TIME), H_RESISTANCE));
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

/* Of a cause with several forms that fit one says it; the next cause is listed behind it. */
static void a_rival_of_two_forms_is_listed_once(void)
{
    diagnosis d = {.causes = 1};
    const hypothesis_id member[] = {H_RESISTANCE};
    make_rivals(5.0);
    parabola(P_DR_A, 0.05, 600.0);
    parabola(P_DR_B, 0.05, 600.0);
    parabola(P_DL_C, 0.05, 600.0);
    confusion_find(&d, view, &state, member,
                   BIT(H_FLUX) | BIT(H_ASYMMETRY_A) | BIT(H_ASYMMETRY_B) | BIT(H_INDUCTANCE_C), 1.0);
    TEST_ASSERT_EQUAL_size_t(3, d.cause[0].confused);
    TEST_ASSERT_EQUAL_STRING("flux_linkage", d.cause[0].confused_with[0]);
    TEST_ASSERT_EQUAL_STRING("phase_asymmetry", d.cause[0].confused_with[1]);
    TEST_ASSERT_EQUAL_STRING("phase_inductance", d.cause[0].confused_with[2]);
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
    RUN_TEST(a_saturation_that_never_has_the_files_inductance_is_two_causes);
    RUN_TEST(gains_in_common_are_a_cause_of_their_own);
    RUN_TEST(the_least_next_to_a_residual_above_the_tolerance);
    RUN_TEST(a_set_in_words);
    RUN_TEST(another_is_as_good_within_fifteen);
    RUN_TEST(all_rivals_are_listed_once);
    RUN_TEST(a_rival_of_two_forms_is_listed_once);
    RUN_TEST(two_that_trade_for_one);
    return UNITY_END();
}

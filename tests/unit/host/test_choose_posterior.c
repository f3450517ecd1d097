/*
 * How sure the diagnosis is (sim_host/diagnose/choose), on sums that are made by hand: how probable a set of hypotheses
 * is, whether it explains as much as it leaves, how certain its sizes and what any coordinate would be.
 */
#include "choose_fixture.h"
#include "diagnose/weigh/borne_out.h"
#include "diagnose/weigh/certainty.h"
#include "diagnose/weigh/estimates.h"
#include "diagnose/weigh/probability.h"

/* ---- How probable, and how sure ---- */

/* Two that explain nearly the same, one better by a little: both together gain nothing, and either stands for the other. */
static void the_probability_is_a_share_of_the_evidence(void)
{
    standing of_all[H_COUNT + 1] = {[H_COUNT] = {.rival = -1.0}}; /* one more, to be left alone */
    const hypothesis_set possible = BIT(H_ASYMMETRY_A) | BIT(H_INDUCTANCE_B) | BIT(H_DEAD_TIME);
    const double inflation = 1.5;
    parabola(P_DR_A, 0.05, 160.0);
    parabola(P_DL_B, 0.05, 158.0);
    view->total.h[P_DR_A][P_DL_B] = view->total.h[P_DR_A][P_DR_A] * 158.0 / 160.0;
    view->total.h[P_DL_B][P_DR_A] = view->total.h[P_DR_A][P_DL_B];
    view->sums = view->total;
    parabola(P_V_DEAD, 0.05, 1.0);
    state.set = BIT(H_ASYMMETRY_A);
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, inflation, NULL, NULL, of_all));
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
    SAME(-1.0, of_all[H_COUNT].rival);
    /* Noisier scores say less. */
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, 3.0 * inflation, NULL, NULL, of_all));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0 / (1.0 + cbrt(other)), of_all[H_ASYMMETRY_A].probability);
}

/* A part of a resistance that the parameter tolerance could explain says nothing against it once it is beyond its threshold. */
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
    TEST_ASSERT_TRUE(probability_of(view, &state, BIT(H_RESISTANCE), 1.0, NULL, NULL, of_all));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, of_all[H_RESISTANCE].probability);
}

/* One that may well be there too: as probable as the set that holds both, compared with the set that was chosen. */
static void the_set_with_one_more_counts(void)
{
    standing of_all[H_COUNT];
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, 0.02, 36.0);
    state.set = BIT(H_RESISTANCE);
    const double more = exp(-0.5 * (of(BIT(H_RESISTANCE) | BIT(H_FLUX)).score - of(BIT(H_RESISTANCE)).score));
    TEST_ASSERT_TRUE(more > 0.3 && more < 1.0);
    probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, NULL, NULL, of_all);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, more / (1.0 + more), of_all[H_FLUX].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, of_all[H_RESISTANCE].probability);
}

/* A fitted set is kept, though the parabola about it has its optimum where one of two that trade is too small for a name. */
static void the_set_that_was_fitted_counts_whatever_the_parabola_says(void)
{
    standing of_all[H_COUNT];
    evidence_option option;
    parabola(P_R, 0.9 * hypothesis_table[H_RESISTANCE].least, 600.0);
    parabola(P_PSI, 0.05, 550.0);
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_FALSE(evidence_cost(view, &state, state.set, &option));
    probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, NULL, NULL, of_all);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, of_all[H_RESISTANCE].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, of_all[H_FLUX].probability);
}

/* A set that only the parabola makes likelier counts by its fit; one that ended too small, or nowhere, not at all. */
static void a_likelier_set_counts_by_its_fit(void)
{
    static const double behind[] = {3.0, -2.0, INFINITY};
    standing of_all[H_COUNT];
    parabola(P_R, 0.05, 600.0);
    parabola(P_PSI, 0.05, 640.0);
    view->total.h[P_R][P_PSI] = view->total.h[P_PSI][P_R] =
        sqrt(view->total.h[P_R][P_R] * view->total.h[P_PSI][P_PSI]);
    view->sums = view->total;
    state.set = BIT(H_RESISTANCE);
    TEST_ASSERT_TRUE(of(BIT(H_FLUX)).score < of(state.set).score);
    probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, NULL, NULL, of_all);
    TEST_ASSERT_TRUE(of_all[H_RESISTANCE].probability < 0.01);
    for (size_t k = 0; k < sizeof behind / sizeof *behind; k++) {
        fit_data data = {.rows = &rows};
        rival_fits fits = {.of = state,
                           .possible = BIT(H_RESISTANCE) | BIT(H_FLUX),
                           .count = 2,
                           .set = {BIT(H_FLUX), BIT(H_RESISTANCE)},
                           .score = {100.0 + behind[k], 100.0}};
        probability_of(view, &state, BIT(H_RESISTANCE) | BIT(H_FLUX), 1.0, &data, &fits, of_all);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0 / (1.0 + exp(-0.5 * behind[k])),
                                  of_all[H_RESISTANCE].probability);
        TEST_ASSERT_EQUAL_size_t(2, fits.count);
    }
}

/*
 * R, L, psi_f and all voltages by one factor: no current changes. Whichever of the four has the file's value, the set costs the same, and
 * its values are those of the file times the factor. A parabola alone would not say so.
 */
static void sets_of_the_same_drive_cost_the_same(void)
{
    coordinate_frame frame = {
        .nominal = {.R_ohm = 0.9, .L_d_H = 0.008, .L_q_H = 0.011, .psi_f_Wb = 0.2, .k_u = 1.0}};
    standing of_all[H_COUNT];
    evidence_option option;
    const hypothesis_set common = BIT(H_RESISTANCE) | BIT(H_DEAD_TIME);
    const hypothesis_set found = common | BIT(H_INDUCTANCE) | BIT(H_FLUX);
    const hypothesis_set possible = found | BIT(H_VOLTAGE_GAIN);
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        frame.scale[k] = 1.0;
    }
    frame.scale[SCALE_R] = 0.9;
    frame.scale[SCALE_PSI] = 0.2;
    view->frame = &frame;
    parabola(P_V_DEAD, 0.5, 500.0);
    parabola(P_R, 0.2, 700.0);
    parabola(COLUMN_L, log(0.95), 700.0);
    parabola(P_PSI, -0.03, 700.0);
    parabola(P_K_U, 1e-6, 1.0);
    state.set = found;
    const evidence_option own = of(found);
    const evidence_option without_flux = of(common | BIT(H_INDUCTANCE) | BIT(H_VOLTAGE_GAIN));
    SAME(own.cost, without_flux.cost);
    SAME(1.0 / 0.97, 1.0 + without_flux.z[P_K_U]);
    SAME(1.2 / 0.97, 1.0 + without_flux.z[P_R]);
    SAME(0.95 / 0.97, exp(without_flux.z[P_L_D]));
    SAME(0.95 / 0.97, exp(without_flux.z[P_L_Q]));
    SAME(0.0, without_flux.z[P_PSI]);
    const evidence_option without_L = of(common | BIT(H_FLUX) | BIT(H_VOLTAGE_GAIN));
    SAME(own.cost, without_L.cost);
    SAME(1.0 / 0.95, 1.0 + without_L.z[P_K_U]);
    /* Only how usual each is tells them apart. */
    SAME(own.score - own.cost - hypotheses_unusual(own.set, own.z) +
             hypothesis_table[H_VOLTAGE_GAIN].surprise,
         without_L.score - without_L.cost - hypotheses_unusual(without_L.set, without_L.z));
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, 1.0, NULL, NULL, of_all));
    const double other = exp(-0.5 * (without_flux.score - own.score));
    const double third = exp(-0.5 * (without_L.score - own.score));
    TEST_ASSERT_TRUE(other > 0.3 && third > 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (1.0 + third) / (1.0 + other + third), of_all[H_FLUX].probability);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, of_all[H_RESISTANCE].probability);
    /* Two of the four are no drive's scale: a third costs what the parabola says. */
    state.set = common | BIT(H_INDUCTANCE);
    evidence_cost(view, &state, common | BIT(H_VOLTAGE_GAIN), &option);
    TEST_ASSERT_TRUE(option.cost > own.cost + 600.0);
}

/* ---- The probability of the catalogue ---- */

static void what_is_left_is_a_share_of_the_power_above_the_noise(void)
{
    /* Up to 1.25 floors is noise: 9 is 1 of noise and 8. */
    SAME(3.0 / 8.0, borne_out_left(3.0, 2.0, 0.8));
    SAME(0.0, borne_out_left(3.0, 1.0, 0.8));
    SAME(0.0, borne_out_left(3.0, 0.5, 0.8));
    SAME(15.0 / 8.0, borne_out_left(3.0, 4.0, 0.8));
    SAME(4.0 / 9.0, borne_out_left(3.0, 2.0, 0.0));
    /* An error within the noise, or none, shows nothing. */
    TEST_ASSERT_TRUE(isnan(borne_out_left(1.0, 0.5, 0.8)));
    TEST_ASSERT_TRUE(isnan(borne_out_left(NAN, 0.5, 0.8)));
    TEST_ASSERT_TRUE(isnan(borne_out_left(NAN, NAN, 0.8)));
    TEST_ASSERT_TRUE(borne_out_left(3.0, NAN, 0.8) == INFINITY);
}

static void a_share_left_has_odds(void)
{
    SAME(10.0 / 11.0, borne_out_probability(NAN));
    SAME(200.0 / 201.0, borne_out_probability(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, borne_out_probability(0.05 * log(200.0)));
    const double odds = 200.0 * exp(-4.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, odds / (1.0 + odds), borne_out_probability(0.2));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, borne_out_probability(1.0));
    SAME(0.0, borne_out_probability(INFINITY));
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

/*
 * A vector's length is certain where no shorter one lies in the ellipse. Along its own line two columns that trade may be as wide as
 * it is long: half widths of 4 each, leaning by 0.98, leave 0.57 across, and a point of length 1 is some 7 half widths away.
 */
static void a_length_is_certain_by_the_shortest_that_fits(void)
{
    certainty c = {.columns = 2, .column = {P_HARMONIC_1C, P_HARMONIC_1S}, .half_width = {4.0, 4.0}};
    c.covariance[0][0] = c.covariance[1][1] = 1.0;
    c.covariance[0][1] = c.covariance[1][0] = 0.98;
    state.z[P_HARMONIC_1C] = 7.0;
    state.z[P_HARMONIC_1S] = -1.0;
    TEST_ASSERT_TRUE(hypothesis_size(H_ANGLE_HARMONIC_1, state.z) -
                         certainty_of_size(&c, &state, H_ANGLE_HARMONIC_1) <
                     4.5);
    TEST_ASSERT_TRUE(certainty_exceeds(&c, &state, H_ANGLE_HARMONIC_1, 4.5));
    /* The nearest point of a length, looked for on its circle. */
    for (double least = 4.6; least < 7.0; least += 0.1) {
        double nearest = INFINITY;
        for (double at = 0.0; at < 6.2831853; at += 1e-4) {
            const double x = least * cos(at) - 7.0;
            const double y = least * sin(at) + 1.0;
            nearest = fmin(nearest, (x * x - 2.0 * 0.98 * x * y + y * y) / (16.0 * (1.0 - 0.98 * 0.98)));
        }
        TEST_ASSERT_TRUE(fabs(nearest - 1.0) < 0.02 ||
                         certainty_exceeds(&c, &state, H_ANGLE_HARMONIC_1, least) == (nearest > 1.0));
    }
    TEST_ASSERT_FALSE(certainty_exceeds(&c, &state, H_ANGLE_HARMONIC_1, 7.2)); /* more than it is */
    /* One column has no way round. */
    certainty one = of_two();
    state.z[P_R] = 0.05;
    TEST_ASSERT_TRUE(certainty_exceeds(&one, &state, H_RESISTANCE, 0.0299));
    TEST_ASSERT_FALSE(certainty_exceeds(&one, &state, H_RESISTANCE, 0.0301));
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
    state.set = BIT(H_RESISTANCE); /* fitted already: the fit decides */
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

/*
 * A magnet's flux that leans on the voltage gain, which may move within its tolerance and is some way off the file's:
 * the step is that of (a b; b c + 1/digits^2), with the prior's own slope. The inductances, not looked at, change nothing.
 */
static void what_leans_on_an_estimate_moves_within_its_digits(void)
{
    const fit_data d = {.rows = &rows};
    rows.sensors = SENSORS_TWO;
    const double a = 4e6;
    const double b = 1e6;
    const double c = 3e6;
    const double prior = 1.0 / (coordinate_table[P_K_U].digits * coordinate_table[P_K_U].digits);
    TEST_ASSERT_TRUE(prior != 1.0 / (coordinate_table[P_L_D].digits * coordinate_table[P_L_D].digits));
    view->sums.h[P_PSI][P_PSI] = a;
    view->sums.h[P_PSI][P_K_U] = view->sums.h[P_K_U][P_PSI] = b;
    view->sums.h[P_K_U][P_K_U] = c;
    view->sums.g[P_PSI] = -2e4;
    view->sums.g[P_K_U] = 5e3;
    state.z[P_K_U] = 5e-4;
    const double slope = 5e3 + 5e-4 * prior;
    const double whole = a * (c + prior) - b * b;
    const estimate found = estimate_of(&d, view, &state, P_PSI, 1.0);
    TEST_ASSERT_TRUE(found.excited);
    SAME((2e4 * (c + prior) + b * slope) / whole, found.z);
    SAME(1.96 * sqrt((c + prior) / whole) + 0.002 * coordinate_table[P_PSI].usual, found.half_width);
}

/* A map that takes the place of a saliency has it: that is no doubt of the saliency, but of its name alone. */
static void a_map_holds_the_saliency_in_it(void)
{
    standing of_all[H_COUNT];
    const hypothesis_set possible = BIT(H_SALIENCY) | BIT(H_MAP_Q);
    parabola(P_L_D, 0.05, 200.0);
    parabola(P_L_Q, -0.05, 200.0);
    parabola(P_W_DQQ, 0.3, 60.0);
    parabola(P_W_QQQQ, 0.3, 60.0);
    state.set = BIT(H_SALIENCY);
    TEST_ASSERT_TRUE(hypothesis_contains(H_MAP_Q, H_SALIENCY));
    TEST_ASSERT_TRUE(probability_of(view, &state, possible, 1.0, NULL, NULL, of_all));
    TEST_ASSERT_TRUE(of_all[H_SALIENCY].alone < 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, of_all[H_SALIENCY].probability);
}

/* Two inductances that differ are a saliency's values: the name is by the size of the difference, which is no doubt of the values. */
static void both_axes_are_no_less_sure_as_a_saliency(void)
{
    standing of_all[H_COUNT];
    parabola(P_L_D, 0.05, 200.0);
    parabola(P_L_Q, 0.08, 200.0);
    state.set = BIT(H_BOTH_AXES);
    TEST_ASSERT_TRUE(probability_of(view, &state, BIT(H_SALIENCY), 1.0, NULL, NULL, of_all));
    TEST_ASSERT_TRUE(of_all[H_BOTH_AXES].alone < 0.95);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, of_all[H_BOTH_AXES].probability);
    TEST_ASSERT_FALSE(hypothesis_contains(H_ASYMMETRY_A, H_RESISTANCE));
    TEST_ASSERT_TRUE(hypothesis_contains(H_ASYMMETRY, H_RESISTANCE));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_probability_is_a_share_of_the_evidence);
    RUN_TEST(a_set_without_a_member_is_weighed_with_its_last_digits_held);
    RUN_TEST(the_set_with_one_more_counts);
    RUN_TEST(the_set_that_was_fitted_counts_whatever_the_parabola_says);
    RUN_TEST(a_likelier_set_counts_by_its_fit);
    RUN_TEST(sets_of_the_same_drive_cost_the_same);
    RUN_TEST(what_is_left_is_a_share_of_the_power_above_the_noise);
    RUN_TEST(a_share_left_has_odds);
    RUN_TEST(what_is_asked_of_a_certainty);
    RUN_TEST(a_cause_of_two_columns_is_weighed_with_both);
    RUN_TEST(a_size_is_as_sure_as_its_columns_together);
    RUN_TEST(a_length_is_certain_by_the_shortest_that_fits);
    RUN_TEST(an_estimate_is_of_the_information);
    RUN_TEST(what_leans_on_an_estimate_moves_within_its_digits);
    RUN_TEST(a_map_holds_the_saliency_in_it);
    RUN_TEST(both_axes_are_no_less_sure_as_a_saliency);
    return UNITY_END();
}

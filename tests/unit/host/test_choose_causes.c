/*
 * What of a found set keeps its name (sim_host/diagnose/choose/causes.h), on sums that are made by hand
 * (choose_causes_fixture.h).
 */
#define _POSIX_C_SOURCE 200809L /* open_memstream */

#include "choose_causes_fixture.h"
#include "diagnose/choose/undecided.h"

/* ---- The loop ---- */

static void nothing_found_is_searched_for_once(void)
{
    prepare();
    KEPT(0);
    TEST_ASSERT_EQUAL_size_t(1, calls);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, least_at[0]);
}

static void what_stands_is_searched_from_once_more(void)
{
    prepare();
    takes(P_R, 0.05, 200.0);
    KEPT(BIT(H_RESISTANCE));
    TEST_ASSERT_EQUAL_size_t(2, calls);
    TEST_ASSERT_EQUAL_size_t(1, fits);
    TEST_ASSERT_TRUE(allowed_at[0] == w.possible && allowed_at[1] == w.possible);
    SAME(0.05, w.state.z[P_R]);
    SAME(inflation, w.certainty.inflation);
    no_memory = true;
    w.state = w.nominal;
    calls = 0;
    TEST_ASSERT_FALSE(causes_find(&w));
}

/* The one that explains least goes first, keeps its parameter tolerance, and is not searched for again. */
static void the_least_of_the_unworthy_goes_first(void)
{
    prepare();
    takes(P_R, 0.05, 40.0);
    takes(P_PSI, 0.05, 30.0);
    takes(P_V_DEAD, 0.5, 300.0);
    const hypothesis_set all = BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_DEAD_TIME);
    TEST_ASSERT_TRUE(kept_of(all) == BIT(H_DEAD_TIME));
    TEST_ASSERT_TRUE(fits >= 3);
    TEST_ASSERT_TRUE(set_fitted[0] == all);
    TEST_ASSERT_TRUE(set_fitted[1] == (BIT(H_RESISTANCE) | BIT(H_DEAD_TIME)));
    TEST_ASSERT_TRUE(set_fitted[2] == BIT(H_DEAD_TIME));
    SAME(3.0 * coordinate_table[P_R].digits, R_before[2]);
    TEST_ASSERT_TRUE(allowed_at[calls - 1] == (w.possible & ~(BIT(H_RESISTANCE) | BIT(H_FLUX))));
}

/* A search that finds more is pruned again, and begins from the motor file's values. */
static void what_is_found_later_is_weighed_too(void)
{
    prepare();
    takes(P_R, 0.05, 200.0);
    takes(P_PSI, 0.05, 200.0);
    proposed[0] = BIT(H_RESISTANCE);
    proposed[1] = proposed[2] = BIT(H_RESISTANCE) | BIT(H_FLUX);
    w.nominal.edge = EDGE_CLIPPED;
    TEST_ASSERT_TRUE(causes_find(&w));
    TEST_ASSERT_TRUE(w.state.set == proposed[1]);
    TEST_ASSERT_EQUAL_size_t(3, calls);
    TEST_ASSERT_EQUAL_size_t(2, fits);
    TEST_ASSERT_EQUAL_INT(EDGE_CLIPPED, w.state.edge);
}

static void after_enough_no_search_begins_but_all_is_weighed(void)
{
    prepare();
    takes(P_R, 0.05, 40.0);
    takes(P_PSI, 0.05, 30.0);
    takes(P_V_DEAD, 0.5, 300.0);
    const hypothesis_set all = BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_DEAD_TIME);
    search_takes = 1.0;
    TEST_ASSERT_TRUE(kept_of(all) == BIT(H_DEAD_TIME));
    TEST_ASSERT_TRUE(calls > 1);
    search_takes = 1e9;
    TEST_ASSERT_TRUE(kept_of(all) == BIT(H_DEAD_TIME));
    TEST_ASSERT_EQUAL_size_t(1, calls);
    /* Roughly while one after the other goes, and what is left as ever. */
    TEST_ASSERT_EQUAL_size_t(4, fits);
    TEST_ASSERT_TRUE(rough[0] && rough[1] && rough[2] && !rough[3]);
    TEST_ASSERT_TRUE(set_fitted[2] == BIT(H_DEAD_TIME) && set_fitted[3] == BIT(H_DEAD_TIME));
    TEST_ASSERT_TRUE(w.allowed == (w.possible & ~(BIT(H_RESISTANCE) | BIT(H_FLUX))));
    /* Another beginning may take half as much. */
    search_takes = 1.0;
    TEST_ASSERT_TRUE(kept_of(all) == BIT(H_DEAD_TIME));
    TEST_ASSERT_TRUE(calls > 1);
}

/* Of a dead time whose compensation may be none, the dead time stays. */
static void a_doubtful_compensation_leaves_its_dead_time(void)
{
    prepare();
    w.possible |= BIT(H_COMPENSATED);
    takes(P_V_DEAD, 0.5, 300.0);
    takes(P_COMPENSATION, 0.3, 100.0);
    half_width[P_V_DEAD] = 1e-3;
    half_width[P_COMPENSATION] = 0.4;
    proposed[0] = BIT(H_COMPENSATED);
    proposed[1] = proposed[2] = BIT(H_DEAD_TIME);
    TEST_ASSERT_TRUE(causes_find(&w));
    TEST_ASSERT_TRUE(w.state.set == BIT(H_DEAD_TIME));
    TEST_ASSERT_TRUE(set_fitted[0] == BIT(H_COMPENSATED) && set_fitted[1] == BIT(H_DEAD_TIME));
    SAME(0.5, w.state.z[P_V_DEAD]);
    SAME(0.0, w.state.z[P_COMPENSATION]);
    /* A certain one stays. */
    half_width[P_COMPENSATION] = 0.05;
    KEPT(BIT(H_COMPENSATED));
}

/* A map of the q axis, all of whose columns show. */
static void takes_a_map(double off)
{
    takes(P_L_D, 0.05, 1.0);
    takes(P_L_Q, 0.05, 1.0);
    takes(P_W_DQQ, 0.05, 1.0);
    takes(P_W_QQQQ, 0.1, off - 3.0);
}

/* Of a flux map no other form is searched for. */
static void a_map_goes_with_all_its_forms(void)
{
    prepare();
    const hypothesis_set maps =
        BIT(H_MAP_TERMS) | BIT(H_MAP_EVEN) | BIT(H_MAP_Q) | BIT(H_MAP) | BIT(H_IRON_1) | BIT(H_IRON_2);
    w.possible |= maps;
    takes_a_map(80.0);
    DROPPED(BIT(H_MAP_Q));
    TEST_ASSERT_TRUE(allowed_at[1] == (w.possible & ~maps));
}

/* One that differs between operating points keeps its name only where it leaves less than half of the error. */
static void a_map_that_differs_between_points_must_leave_little(void)
{
    prepare();
    w.possible |= BIT(H_MAP_Q);
    takes_a_map(900.0);
    factor[P_W_DQQ] = 0.6;
    scatter[CAUSE_SATURATION_DQ] = 0.29;
    KEPT(BIT(H_MAP_Q));
    scatter[CAUSE_SATURATION_DQ] = 0.31;
    DROPPED(BIT(H_MAP_Q));
    factor[P_W_DQQ] = 0.51;
    DROPPED(BIT(H_MAP_Q));
    factor[P_W_DQQ] = 0.49;
    KEPT(BIT(H_MAP_Q));
    /* Other laws have one shape. */
    takes(P_R, 0.05, 200.0);
    scatter[CAUSE_RESISTANCE] = 0.31;
    KEPT(BIT(H_RESISTANCE));
}

/* Next to a map a name takes a hundredth of what all explain on top of what it pays. */
static void a_name_next_to_a_map_takes_more(void)
{
    prepare();
    w.possible |= BIT(H_MAP_Q);
    takes_a_map(900.0);
    takes(P_R, 0.05, 54.0); /* of 37, 9.2 for the odds and 9.5 */
    TEST_ASSERT_TRUE(kept_of(BIT(H_MAP_Q) | BIT(H_RESISTANCE)) == BIT(H_MAP_Q));
    takes(P_R, 0.05, 57.0);
    KEPT(BIT(H_MAP_Q) | BIT(H_RESISTANCE));
}

/* ---- Its posterior ---- */

static void the_odds_of_a_name(void)
{
    prepare();
    const double pays = 25.0 + 12.0;
    takes(P_R, 0.05, pays + 9.19);
    DROPPED(BIT(H_RESISTANCE));
    takes(P_R, 0.05, pays + 9.21);
    KEPT(BIT(H_RESISTANCE));
    inflation = 2.0;
    takes(P_R, 0.05, 2.0 * (pays + 9.19));
    DROPPED(BIT(H_RESISTANCE));
    takes(P_R, 0.05, 2.0 * (pays + 9.21));
    KEPT(BIT(H_RESISTANCE));
}

/* If several explain nearly the same, one stays that is more likely than not, or in the likeliest set. */
static void it_is_likely_or_in_the_likeliest_set(void)
{
    prepare();
    w.possible = BIT(H_ASYMMETRY_A) | BIT(H_INDUCTANCE_B);
    crowd[P_DR_A] = crowd[P_DL_B] = crowd[P_DL_C] = true;
    lean = 0.999;
    takes(P_DR_A, 0.05, 200.0);
    takes(P_DL_B, 0.05, 202.0);
    takes(P_DL_C, 0.05, 199.0);
    DROPPED(BIT(H_ASYMMETRY_A));
    takes(P_DL_B, 0.05, 199.0);
    KEPT(BIT(H_ASYMMETRY_A));
    w.possible |= BIT(H_INDUCTANCE_C);
    KEPT(BIT(H_ASYMMETRY_A)); /* less likely than not, as one of three */
    takes(P_DL_C, 0.05, 202.0);
    DROPPED(BIT(H_ASYMMETRY_A));
}

/* One that another explains as well stays in the model, and is no cause: which of them it is the recording does not decide. */
static void what_another_explains_as_well_is_no_cause(void)
{
    prepare();
    w.possible = BIT(H_ASYMMETRY_A) | BIT(H_INDUCTANCE_B) | BIT(H_RESISTANCE);
    crowd[P_DR_A] = crowd[P_DL_B] = true;
    lean = 0.999;
    takes(P_DR_A, 0.05, 200.0);
    takes(P_DL_B, 0.05, 199.0);
    takes(P_R, 0.05, 200.0);
    const hypothesis_set both = BIT(H_ASYMMETRY_A) | BIT(H_RESISTANCE);
    KEPT(both);
    w.borne_out = 1.0;
    w.minor = w.undecided = 0;
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_NAMED));
    TEST_ASSERT_TRUE(w.state.set == both && w.minor == BIT(H_ASYMMETRY_A) && w.undecided == w.minor);
    SAME(0.05, w.state.z[P_DR_A]);
    /* Of a fit of likely effects the likelier one is. */
    w.minor = w.undecided = 0;
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_LIKELY));
    TEST_ASSERT_TRUE(w.minor == 0 && w.undecided == 0);
    takes(P_DL_B, 0.05, 201.0);
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_LIKELY));
    TEST_ASSERT_TRUE(w.minor == BIT(H_ASYMMETRY_A) && w.undecided == w.minor);
    /* One that explains less by the odds of 0.95 leaves nothing open. */
    w.minor = w.undecided = 0;
    takes(P_DL_B, 0.05, 180.0);
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_NAMED));
    TEST_ASSERT_TRUE(w.minor == 0 && w.undecided == 0);
    /* A small one is no cause, so it is not open either. */
    takes(P_DL_B, 0.05, 199.0);
    w.minor = BIT(H_ASYMMETRY_A);
    w.undecided = 0;
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_NAMED));
    TEST_ASSERT_TRUE(w.minor == BIT(H_ASYMMETRY_A) && w.undecided == 0);
}

/* Where an effect outside the catalogue may well explain the error, none is a cause. */
static void what_the_catalogue_does_not_bear_out_is_no_cause(void)
{
    prepare();
    w.possible = BIT(H_ASYMMETRY_A) | BIT(H_RESISTANCE);
    takes(P_DR_A, 0.05, 200.0);
    takes(P_R, 0.05, 200.0);
    const hypothesis_set both = BIT(H_ASYMMETRY_A) | BIT(H_RESISTANCE);
    KEPT(both);
    w.minor = w.undecided = 0;
    w.borne_out = 0.951;
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_NAMED));
    TEST_ASSERT_TRUE(w.minor == 0 && w.undecided == 0);
    w.borne_out = 0.949;
    TEST_ASSERT_TRUE(undecided_accuse_none(&w, UNDECIDED_NAMED));
    TEST_ASSERT_TRUE(w.state.set == both && w.minor == both && w.undecided == both);
}

/* By what the model errs, 0.006 of it, as well. */
static void it_is_larger_than_its_least(void)
{
    prepare();
    takes(P_R, 0.05, 200.0);
    half_width[P_R] = 0.0298;
    KEPT(BIT(H_RESISTANCE));
    half_width[P_R] = 0.0299;
    DROPPED(BIT(H_RESISTANCE));
    w.frame.of_least = 0.5;
    half_width[P_R] = 0.0399;
    KEPT(BIT(H_RESISTANCE));
    half_width[P_R] = 0.0401;
    DROPPED(BIT(H_RESISTANCE));
}

/* A dead time's law is not exact near zero current, and the others take 0.3 of their thresholds for what it misses. */
static void next_to_a_dead_time_it_is_larger_by_more(void)
{
    prepare();
    takes(P_R, 0.05, 200.0);
    takes(P_V_DEAD, 0.5, 300.0);
    half_width[P_R] = 0.0239;
    KEPT(BIT(H_RESISTANCE) | BIT(H_DEAD_TIME));
    half_width[P_R] = 0.0241;
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | BIT(H_DEAD_TIME)) == BIT(H_DEAD_TIME));
    /* Not a fit of the whole drive, which holds what is small as well. */
    w.state.set = BIT(H_RESISTANCE) | BIT(H_DEAD_TIME);
    w.state.z[P_R] = 0.05;
    w.certainty = (certainty){.columns = 1, .column = {P_R}, .half_width = {0.0298}};
    w.way = SESSION_WHOLE_DRIVE;
    TEST_ASSERT_TRUE(session_is_large(&w, H_RESISTANCE));
    w.way = SESSION_SEARCH;
    TEST_ASSERT_FALSE(session_is_large(&w, H_RESISTANCE));
}

static hypothesis_set first_then(hypothesis_set first, hypothesis_set then)
{
    calls = fits = 0;
    w.state = w.nominal;
    proposed[0] = first;
    for (size_t k = 1; k < MOST_CALLS; k++) {
        proposed[k] = then;
    }
    TEST_ASSERT_TRUE(causes_find(&w));
    return w.state.set;
}

/* A delay of whole cycles stays if its remaining part of a cycle is below the reporting threshold. */
static void of_a_part_that_goes_whole_cycles_stay(void)
{
    const hypothesis_set all = BIT(H_VOLTAGE_DELAY_1) | BIT(H_VOLTAGE_DELAY_2) | BIT(H_VOLTAGE_DELAY_PART) |
                               BIT(H_VOLTAGE_DELAY_MORE);
    prepare();
    w.possible |= all;
    takes(P_U_DELAY_1, 1.0, 500.0);
    takes(P_U_DELAY_2, 0.12, 60.0);
    half_width[P_U_DELAY_2] = 0.05;
    TEST_ASSERT_TRUE(first_then(BIT(H_VOLTAGE_DELAY_MORE), BIT(H_VOLTAGE_DELAY_1)) == BIT(H_VOLTAGE_DELAY_1));
    TEST_ASSERT_EQUAL_size_t(2, fits); /* with the part, and without: weighed at once */
    TEST_ASSERT_TRUE(set_fitted[1] == BIT(H_VOLTAGE_DELAY_1));
    half_width[P_U_DELAY_2] = 0.01;
    takes(P_U_DELAY_2, 0.4, 60.0);
    KEPT(BIT(H_VOLTAGE_DELAY_MORE));
    prepare();
    w.possible |= all;
    takes(P_U_DELAY_1, 0.12, 500.0);
    half_width[P_U_DELAY_1] = 0.05;
    DROPPED(BIT(H_VOLTAGE_DELAY_PART)); /* no whole cycle is nothing */
}

/* ---- What is reported ---- */

static void dropped_causes_are_reported(void)
{
    prepare();
    char *text = NULL;
    size_t size = 0;
    w.teller.trace = open_memstream(&text, &size);
    TEST_ASSERT_NOT_NULL(w.teller.trace);
    takes(P_R, 0.05, 40.0);
    proposed[0] = BIT(H_RESISTANCE);
    TEST_ASSERT_TRUE(causes_find(&w));
    fclose(w.teller.trace);
    w.teller.trace = NULL;
    TEST_ASSERT_EQUAL_STRING("  not certain, or too small a part: winding resistance\n", text);
    free(text);
}

static void differences_between_points_are_reported(void)
{
    prepare();
    char *text = NULL;
    size_t size = 0;
    w.teller.trace = open_memstream(&text, &size);
    TEST_ASSERT_NOT_NULL(w.teller.trace);
    takes(P_R, 0.05, 200.0);
    takes(P_PSI, 0.05, 200.0);
    takes(P_V_DEAD, 0.5, 300.0);
    proposed[0] = proposed[1] = BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_DEAD_TIME);
    scatter[CAUSE_RESISTANCE] = 0.012;
    scatter[CAUSE_DEAD_TIME] = -1.0;   /* no more than noise does; of the flux nothing is known, */
    scatter[CAUSE_VOLTAGE_GAIN] = 0.5; /* and this does not stand */
    TEST_ASSERT_TRUE(causes_find(&w));
    fclose(w.teller.trace);
    w.teller.trace = NULL;
    TEST_ASSERT_EQUAL_STRING(
        "  between operating points resistance differs by 1.2 %\n"
        "  between operating points dead_time differs by 0 % at the most that noise does\n",
        text);
    free(text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_found_is_searched_for_once);
    RUN_TEST(what_stands_is_searched_from_once_more);
    RUN_TEST(the_least_of_the_unworthy_goes_first);
    RUN_TEST(what_is_found_later_is_weighed_too);
    RUN_TEST(a_doubtful_compensation_leaves_its_dead_time);
    RUN_TEST(after_enough_no_search_begins_but_all_is_weighed);
    RUN_TEST(a_map_goes_with_all_its_forms);
    RUN_TEST(a_map_that_differs_between_points_must_leave_little);
    RUN_TEST(a_name_next_to_a_map_takes_more);
    RUN_TEST(the_odds_of_a_name);
    RUN_TEST(it_is_likely_or_in_the_likeliest_set);
    RUN_TEST(what_another_explains_as_well_is_no_cause);
    RUN_TEST(what_the_catalogue_does_not_bear_out_is_no_cause);
    RUN_TEST(it_is_larger_than_its_least);
    RUN_TEST(next_to_a_dead_time_it_is_larger_by_more);
    RUN_TEST(of_a_part_that_goes_whole_cycles_stay);
    RUN_TEST(dropped_causes_are_reported);
    RUN_TEST(differences_between_points_are_reported);
    return UNITY_END();
}

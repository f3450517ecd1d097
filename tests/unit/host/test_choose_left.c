/*
 * What a cause must explain next to the residual and to effects without a name (sim_host/diagnose/choose/causes.h), on sums that are made
 * by hand (choose_causes_fixture.h).
 */
#include "choose_causes_fixture.h"

/* ---- What is left ---- */

static void a_name_takes_a_twentieth_of_what_is_left(void)
{
    prepare();
    floor_A = 1.0;
    current_A = 1.0;
    error_of_file = 200.0; /* two floors: what is left is three times what the noise does */
    takes(P_R, 0.05, 129.0);
    DROPPED(BIT(H_RESISTANCE)); /* of 3 * 871 */
    SAME(0.5 * 0.05 * 3.0 * (WORST - 129.0), least_at[1]);
    takes(P_R, 0.05, 132.0);
    KEPT(BIT(H_RESISTANCE)); /* of 3 * 868 */
    /* Up to one and a quarter floors nothing is. */
    error_of_file = 125.0;
    takes(P_R, 0.05, 50.0);
    KEPT(BIT(H_RESISTANCE));
    error_of_file = 126.0; /* 0.5876 of 950, a twentieth of that: 27.9 */
    KEPT(BIT(H_RESISTANCE));
    error_of_file = 180.0; /* 2.24 */
    DROPPED(BIT(H_RESISTANCE));
    current_A = 0.5;
    KEPT(BIT(H_RESISTANCE));
    current_A = 1.0;
    floor_A = 0.0; /* nothing to measure it by */
    KEPT(BIT(H_RESISTANCE));
}

/* ---- Next to an effect without a name ---- */

static void a_name_takes_a_twentieth_of_what_it_shares_with_the_unnamed(void)
{
    prepare();
    factor[P_R] = 0.5; /* it makes others better */
    takes(P_ZONE, 0.05, 900.0);
    takes(P_R, 0.05, 47.1);
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | ZONE) == ZONE); /* 900/19 = 47.4 */
    takes(P_R, 0.05, 47.7);
    KEPT(BIT(H_RESISTANCE) | ZONE);
}

/* In doubt, it makes held-out rows better by half a part in a hundred, and nothing else fits as well. */
static void a_name_next_to_as_much_without_a_name_helps_others(void)
{
    prepare();
    takes(P_ZONE, 0.05, 100.0);
    takes(P_R, 0.05, 399.0);
    factor[P_R] = 1.0 / 1.004;
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | ZONE) == ZONE);
    factor[P_R] = 1.0 / 1.006;
    KEPT(BIT(H_RESISTANCE) | ZONE);
    takes(P_PSI, 0.05, 385.0); /* flux fits as well */
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | ZONE) == ZONE);
    takes(P_PSI, 0.05, 383.0);
    KEPT(BIT(H_RESISTANCE) | ZONE);
    takes(P_PSI, 0.05, 390.0); /* and in flux's place resistance does */
    factor[P_PSI] = 0.5;
    TEST_ASSERT_TRUE(kept_of(BIT(H_FLUX) | ZONE) == ZONE);
    w.possible &= ~BIT(H_RESISTANCE);
    KEPT(BIT(H_FLUX) | ZONE);
    w.possible |= BIT(H_RESISTANCE);
    takes(P_PSI, 0.05, 383.0);
    inflation = 1.1;
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | ZONE) == ZONE);
    w.possible &= ~BIT(H_FLUX); /* but this recording does not show one */
    KEPT(BIT(H_RESISTANCE) | ZONE);
    inflation = 1.0;
    /* No doubt where it takes four times as much; worse than without it, it may not be. */
    takes(P_R, 0.05, 401.0);
    factor[P_R] = 1.0;
    KEPT(BIT(H_RESISTANCE) | ZONE);
    factor[P_R] = 1.001;
    TEST_ASSERT_TRUE(kept_of(BIT(H_RESISTANCE) | ZONE) == ZONE);
}

/* Next to a dead time others may not make held-out rows worse; alone they may. */
static void a_name_next_to_a_dead_time_harms_none(void)
{
    prepare();
    takes(P_V_DEAD, 0.5, 300.0);
    takes(P_R, 0.05, 100.0);
    factor[P_V_DEAD] = 0.5;
    const hypothesis_set both = BIT(H_RESISTANCE) | BIT(H_DEAD_TIME);
    factor[P_R] = 1.0;
    KEPT(both);
    factor[P_R] = 1.001;
    TEST_ASSERT_TRUE(kept_of(both) == BIT(H_DEAD_TIME));
    KEPT(BIT(H_RESISTANCE));
}

/* Where the named ones reach the noise next to a dead time, what has no name goes first, certain or not. */
static void what_a_dead_time_leaves_is_no_effect_without_a_name(void)
{
    prepare();
    const hypothesis_set both = ZONE | BIT(H_DEAD_TIME);
    takes(P_V_DEAD, 0.5, 600.0);
    takes(P_ZONE, 0.05, 100.0);
    factor[P_V_DEAD] = 0.5;
    floor_A = 1.0;
    error_of_file = 250.0;
    TEST_ASSERT_TRUE(kept_of(both) == BIT(H_DEAD_TIME));
    error_of_file = 252.0;
    factor[P_ZONE] = 0.9;
    KEPT(both);
    error_of_file = 250.0;
    floor_A = 0.0;
    KEPT(both);
    floor_A = 1.0;
    KEPT(ZONE); /* there is no dead time */
    takes(P_R, 0.05, 390.0);
    takes(P_ZONE, 0.05, 90.0);
    factor[P_R] = 0.5;
    KEPT(ZONE | BIT(H_RESISTANCE));
}

/* ---- Explained against left, all together ---- */

static hypothesis_set borne_out_of(hypothesis_set set)
{
    kept_of(set);
    TEST_ASSERT_TRUE(w.state.set == set);
    calls = 0;
    w.more_left = false;
    TEST_ASSERT_TRUE(causes_bear_out(&w));
    return w.state.set;
}

/* With a floor of 40 %, up to 50 % is noise. The catalogue is the likelier one up to log(200)/20 of the 7500 above that. */
static void names_that_leave_more_than_the_catalogue_would_go(void)
{
    const double most = sqrt(2500.0 + 7500.0 * log(200.0) / 20.0) / 100.0;
    prepare();
    takes(P_R, 0.05, 200.0);
    error_of_file = 100.0;
    floor_A = 0.4;
    factor[P_R] = most - 1e-3;
    TEST_ASSERT_TRUE(borne_out_of(BIT(H_RESISTANCE)) == BIT(H_RESISTANCE));
    TEST_ASSERT_FALSE(w.more_left);
    TEST_ASSERT_EQUAL_size_t(0, calls);
    factor[P_R] = most + 1e-3;
    TEST_ASSERT_TRUE(borne_out_of(BIT(H_RESISTANCE)) == 0);
    TEST_ASSERT_TRUE(w.more_left);
    TEST_ASSERT_TRUE(allowed_at[0] == ZONE); /* none of the others explains more */
    /* A set without a name is not weighed, nor a file with its own dead time. */
    takes(P_ZONE, 0.05, 150.0);
    TEST_ASSERT_TRUE(borne_out_of(ZONE) == ZONE);
    w.frame.nominal.v_dead_V = 0.1;
    TEST_ASSERT_TRUE(borne_out_of(BIT(H_RESISTANCE)) == BIT(H_RESISTANCE));
    TEST_ASSERT_FALSE(w.more_left);
}

/* The model with all its members shows how much of the floor is noise. */
static void structure_does_not_count_as_noise(void)
{
    prepare();
    takes(P_R, 0.05, 400.0);
    takes(P_ZONE, 0.05, 60.0);
    error_of_file = 100.0;
    factor[P_R] = 0.6;
    floor_A = 0.6;
    factor[P_ZONE] = 0.9;
    TEST_ASSERT_TRUE(borne_out_of(BIT(H_RESISTANCE) | ZONE) == (BIT(H_RESISTANCE) | ZONE));
    factor[P_ZONE] = 0.1;
    TEST_ASSERT_TRUE(borne_out_of(BIT(H_RESISTANCE) | ZONE) == ZONE);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_name_takes_a_twentieth_of_what_is_left);
    RUN_TEST(a_name_takes_a_twentieth_of_what_it_shares_with_the_unnamed);
    RUN_TEST(a_name_next_to_as_much_without_a_name_helps_others);
    RUN_TEST(a_name_next_to_a_dead_time_harms_none);
    RUN_TEST(what_a_dead_time_leaves_is_no_effect_without_a_name);
    RUN_TEST(names_that_leave_more_than_the_catalogue_would_go);
    RUN_TEST(structure_does_not_count_as_noise);
    return UNITY_END();
}

/*
 * When a search begins once more, and which of two states stands (sim_host/diagnose/choose/reconsider.h), on sums that are made by
 * hand (choose_causes_fixture.h).
 */
#include "choose_causes_fixture.h"

#include "diagnose/choose/reconsider.h"
#include "diagnose/identify/revolution.h"

static size_t aligned;
static hypothesis_set aligned_under;

bool __wrap_search_score(fit_data *d, const fit_state *s, double *score);
bool __wrap_revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned);

bool __wrap_search_score(fit_data *d, const fit_state *s, double *score)
{
    (void)d;
    *score = s->objective;
    return true;
}

bool __wrap_revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned)
{
    (void)d;
    (void)pole_pairs;
    *turned = false;
    aligned++;
    aligned_under = s->set;
    return !no_memory;
}

/* After a first search that found `first`, one that would find `second`. */
static hypothesis_set found_after(hypothesis_set first, hypothesis_set second)
{
    TEST_ASSERT_TRUE(kept_of(first) == first);
    calls = fits = aligned = 0;
    for (size_t k = 0; k < MOST_CALLS; k++) {
        proposed[k] = second;
    }
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    return w.state.set;
}

static void what_has_no_name_is_left_out_once(void)
{
    prepare();
    takes(P_ZONE, 0.05, 300.0);
    takes(P_R, 0.05, 301.0);
    TEST_ASSERT_TRUE(found_after(ZONE, BIT(H_RESISTANCE)) == BIT(H_RESISTANCE));
    TEST_ASSERT_TRUE(allowed_at[0] == (w.possible & ~hypotheses_of(CAUSE_SENSOR_BEND)));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, least_at[0]);
    TEST_ASSERT_EQUAL_size_t(0, aligned);
    /* The worse does not stand, and the stretches are turned back. */
    takes(P_R, 0.05, 299.0);
    TEST_ASSERT_TRUE(found_after(ZONE, BIT(H_RESISTANCE)) == ZONE);
    TEST_ASSERT_EQUAL_size_t(1, calls);
    TEST_ASSERT_EQUAL_size_t(1, aligned);
    TEST_ASSERT_TRUE(aligned_under == ZONE);
    SAME(0.05, w.state.z[P_ZONE]);
    SAME(0.0, w.state.z[P_R]);
    no_memory = true;
    TEST_ASSERT_FALSE(reconsider(&w, &nobody));
}

/* The better one's names are weighed like any. */
static void what_is_found_then_is_weighed(void)
{
    prepare();
    takes(P_ZONE, 0.05, 300.0);
    takes(P_R, 0.05, 400.0);
    half_width[P_R] = 0.04;
    TEST_ASSERT_TRUE(found_after(ZONE, BIT(H_RESISTANCE)) == 0);
}

static void what_was_dropped_is_left_out_where_something_is_left(void)
{
    prepare();
    floor_A = 1.0;
    takes(P_R, 0.05, 400.0);
    takes(P_PSI, 0.05, 500.0);
    error_of_file = 126.0;
    TEST_ASSERT_TRUE(found_after(BIT(H_RESISTANCE), BIT(H_FLUX)) == BIT(H_RESISTANCE));
    TEST_ASSERT_EQUAL_size_t(0, calls); /* nothing was dropped: the same would be found */
    w.allowed &= ~BIT(H_DEAD_TIME);
    w.fitted.effort = 1e9;
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    TEST_ASSERT_EQUAL_size_t(0, calls);
    w.fitted.effort = 0.0;
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    TEST_ASSERT_TRUE(w.state.set == BIT(H_FLUX));
    TEST_ASSERT_TRUE(allowed_at[0] == (w.possible & ~BIT(H_DEAD_TIME)));
}

/* The last of the first searches began with nothing, and without what was dropped. */
static void where_nothing_stood_nothing_is_searched_for(void)
{
    prepare();
    floor_A = 1.0;
    takes(P_PSI, 0.05, 500.0);
    error_of_file = 200.0;
    kept_of(0);
    w.allowed &= ~BIT(H_DEAD_TIME);
    TEST_ASSERT_TRUE(session_leaves_something(&w));
    calls = 0;
    proposed[0] = BIT(H_FLUX);
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    TEST_ASSERT_EQUAL_size_t(0, calls);
    TEST_ASSERT_TRUE(w.state.set == 0);
}

static void at_the_noise_nothing_is_searched_for(void)
{
    prepare();
    floor_A = 1.0;
    takes(P_R, 0.05, 400.0);
    error_of_file = 124.0;
    kept_of(BIT(H_RESISTANCE));
    w.allowed &= ~BIT(H_DEAD_TIME);
    calls = 0;
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    error_of_file = 200.0;
    floor_A = 0.0; /* nothing to measure it by */
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    TEST_ASSERT_EQUAL_size_t(0, calls);
    floor_A = 1.0;
    current_A = 0.5;
    TEST_ASSERT_TRUE(reconsider(&w, &nobody));
    TEST_ASSERT_EQUAL_size_t(0, calls);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_has_no_name_is_left_out_once);
    RUN_TEST(what_is_found_then_is_weighed);
    RUN_TEST(what_was_dropped_is_left_out_where_something_is_left);
    RUN_TEST(where_nothing_stood_nothing_is_searched_for);
    RUN_TEST(at_the_noise_nothing_is_searched_for);
    return UNITY_END();
}

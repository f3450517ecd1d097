/* Sets whose fits are remembered (sim_host/diagnose/weigh/fitted_sets.h). */
#include "diagnose/weigh/fitted_sets.h"

#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

#define BIT(h) HYPOTHESIS_BIT(h)

static fit_state state_of(hypothesis_set set, double R)
{
    fit_state s = {.set = set};
    s.z[P_R] = R;
    return s;
}

static void what_was_fitted_is_found_by_what_was_asked(void)
{
    const hypothesis_set all = ~(hypothesis_set)0;
    fitted_sets f = {0};
    TEST_ASSERT_NULL(fitted_sets_find(&f, BIT(H_RESISTANCE), all));
    /* More than the first room, each with a set and numbers of its own. */
    for (int n = 1; n <= 100; n++) {
        const fit_state s = state_of(BIT(H_RESISTANCE), n);
        fitted_sets_keep(&f, (hypothesis_set)n, &s, 0.5 * n);
    }
    for (int n = 1; n <= 100; n++) {
        const fitted_set *one = fitted_sets_find(&f, (hypothesis_set)n, all);
        TEST_ASSERT_NOT_NULL(one);
        TEST_ASSERT_EQUAL_DOUBLE(n, one->state.z[P_R]);
        TEST_ASSERT_EQUAL_DOUBLE(0.5 * n, one->worth);
    }
    TEST_ASSERT_NULL(fitted_sets_find(&f, 101, all));
    fitted_sets_free(&f);
    TEST_ASSERT_EQUAL_size_t(0, f.count);
    TEST_ASSERT_NULL(f.one);
}

/* What was asked for may have come out as something else; that is what must be allowed. */
static void what_is_not_allowed_is_not_found(void)
{
    const hypothesis_set asked = BIT(H_SATURATION);
    const fit_state s = state_of(BIT(H_INDUCTANCE), 0.0);
    fitted_sets f = {0};
    fitted_sets_keep(&f, asked, &s, 0.0);
    TEST_ASSERT_NOT_NULL(fitted_sets_find(&f, asked, BIT(H_INDUCTANCE) | BIT(H_FLUX)));
    TEST_ASSERT_NULL(fitted_sets_find(&f, asked, asked | BIT(H_FLUX)));
    fitted_sets_free(&f);
}

static void another_law_of_the_edges_knows_none(void)
{
    const fit_state s = state_of(BIT(H_RESISTANCE), 1.0);
    fitted_sets f = {0};
    fitted_sets_keep(&f, s.set, &s, 0.0);
    fitted_sets_forget(&f, EDGE_CHARGED);
    TEST_ASSERT_EQUAL_INT(EDGE_CHARGED, f.edge);
    TEST_ASSERT_NULL(fitted_sets_find(&f, s.set, s.set));
    fitted_sets_free(&f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_was_fitted_is_found_by_what_was_asked);
    RUN_TEST(what_is_not_allowed_is_not_found);
    RUN_TEST(another_law_of_the_edges_knows_none);
    return UNITY_END();
}

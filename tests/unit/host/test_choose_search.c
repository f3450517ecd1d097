/*
 * Which options of a round are fitted, and from where (sim_host/diagnose/weigh/search.h). The program is linked so that looks are
 * parabolas made by hand, and a fit finds their bottom wherever the model gives a number.
 */
#include "choose_parabolas.h"
#include "diagnose/identify/branch_choice.h"
#include "diagnose/identify/edge_choice.h"
#include "diagnose/identify/fit.h"
#include "diagnose/identify/revolution.h"
#include "diagnose/weigh/fitted_sets.h"
#include "diagnose/weigh/search.h"
#include "diagnose/weigh/tolerance.h"

enum { MOST_FITS = 64 };

static double R_without_number; /* from there on the model gives none */
static size_t rows_without;     /* with more rows than these it gives none anywhere */
static double iron_ends;        /* a fit multiplies that current by it */
static fit_data data;
static coordinate_frame frame;
static size_t fits;
static fit_state begun[MOST_FITS];
static size_t begun_by[MOST_FITS]; /* rows */
static size_t looks;
static size_t look_by[MOST_FITS];

void __wrap_fit_noise(fit_data *d, fit_state *s);
void __wrap_fit_data_select(fit_data *d, size_t rows_max);
bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);
bool __wrap_evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *seen);
bool __wrap_tolerance_of_state(fit_data *d, const fit_state *s, double *worth);
bool __wrap_edge_choose(fit_data *d, fit_state *s);
bool __wrap_branch_choose(fit_data *d, fit_state *s);
bool __wrap_revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned);

bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone)
{
    (void)iterations;
    (void)aim;
    TEST_ASSERT_TRUE(fits < MOST_FITS);
    begun_by[fits] = d->rows_fitted;
    begun[fits++] = *s;
    if (fabs(s->z[P_R]) > R_without_number || d->rows_fitted > rows_without) {
        *alone = s->objective = NAN;
        return true;
    }
    to_bottom(s);
    s->z[P_IRON] *= iron_ends;
    *alone = s->objective;
    return true;
}

void __wrap_fit_noise(fit_data *d, fit_state *s)
{
    (void)d;
    s->objective = WORST;
}

void __wrap_fit_data_select(fit_data *d, size_t rows_max)
{
    d->rows_fitted = rows_max < d->rows_max ? rows_max : d->rows_max;
}

bool __wrap_evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *seen)
{
    (void)allowed;
    TEST_ASSERT_TRUE(looks < MOST_FITS);
    look_by[looks++] = d->rows_fitted;
    *seen = (evidence_view){.rows = &rows, .edge = s->edge, .of_least = 1.0};
    parabolas_seen(s, seen);
    return true;
}

bool __wrap_tolerance_of_state(fit_data *d, const fit_state *s, double *worth)
{
    (void)d;
    (void)s;
    *worth = 0.0;
    return true;
}

bool __wrap_edge_choose(fit_data *d, fit_state *s)
{
    (void)d;
    (void)s;
    return true;
}

bool __wrap_branch_choose(fit_data *d, fit_state *s)
{
    (void)d;
    (void)s;
    return true;
}

bool __wrap_revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned)
{
    (void)d;
    (void)s;
    (void)pole_pairs;
    *turned = false;
    return true;
}

static void prepare(void)
{
    parabolas_none();
    frame = (coordinate_frame){.of_least = 1.0, .i_rated_peak_A = 10.0};
    frame.nominal = (averaged_drive){.R_ohm = 1.0,
                                     .L_d_H = 1e-3,
                                     .L_q_H = 1e-3,
                                     .psi_f_Wb = 1.0,
                                     .i_knee_A = 0.1,
                                     .compensation_knee_A = 0.1,
                                     .fe_tau_s = 1.0,
                                     .k_u = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        frame.scale[k] = 1.0;
    }
    data = (fit_data){.rows = &rows, .frame = &frame};
    R_without_number = INFINITY;
    rows_without = SIZE_MAX;
    iron_ends = 1.0;
    state = fit_nominal();
    state.objective = WORST;
}

/* The set that a search ends with. */
static hypothesis_set search(hypothesis_set allowed)
{
    static const diagnose_teller nobody = {0};
    fitted_sets fitted = {0};
    fits = looks = 0;
    TEST_ASSERT_TRUE(search_best(&data, &state, allowed, WORST, 0.0, &fitted, view, &nobody));
    fitted_sets_free(&fitted);
    return state.set;
}

static void a_fit_begins_where_the_parabola_ends(void)
{
    prepare();
    takes(P_R, 0.4, 300.0);
    TEST_ASSERT_TRUE(search(BIT(H_RESISTANCE)) == BIT(H_RESISTANCE));
    TEST_ASSERT_EQUAL_size_t(1, fits);
    TEST_ASSERT_EQUAL_DOUBLE(0.4, begun[0].z[P_R]);
}

/* Half of the way, a quarter: as near as it must. What is or is not is there at once. */
static void where_the_model_gives_no_number_a_fit_begins_on_the_way_there(void)
{
    prepare();
    takes(P_R, 0.4, 300.0);
    takes(P_U_DELAY_1, 1.0, 500.0);
    R_without_number = 0.12;
    const hypothesis_set both = BIT(H_RESISTANCE) | BIT(H_VOLTAGE_DELAY_1);
    TEST_ASSERT_TRUE(search(both) == both);
    size_t steps = 0;
    for (size_t k = 0; k < fits; k++) {
        if (begun[k].set == both) {
            SAME(ldexp(0.4, -(int)steps), begun[k].z[P_R]);
            steps++;
            TEST_ASSERT_EQUAL_DOUBLE(1.0, begun[k].z[P_U_DELAY_1]);
        }
    }
    TEST_ASSERT_EQUAL_size_t(3, steps);
    /* From a state that is late on: without the delay there is none of it, however near the fit begins. */
    fit_state late = fit_nominal();
    late.set = BIT(H_VOLTAGE_DELAY_1);
    late.z[P_U_DELAY_1] = 1.0;
    late.objective = WORST;
    less[P_U_DELAY_1] = 0.0;
    state = late;
    TEST_ASSERT_TRUE(search(both) == BIT(H_RESISTANCE));
    for (size_t k = 0; k < fits; k++) {
        TEST_ASSERT_TRUE(begun[k].set == BIT(H_RESISTANCE));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, begun[k].z[P_U_DELAY_1]);
    }
    TEST_ASSERT_EQUAL_size_t(3, fits);
}

static void no_number_near_by_is_given_up(void)
{
    prepare();
    takes(P_R, 0.4, 300.0);
    R_without_number = 0.001;
    TEST_ASSERT_TRUE(search(BIT(H_RESISTANCE)) == 0);
    TEST_ASSERT_EQUAL_size_t(4, fits); /* down to an eighth */
    SAME(0.05, begun[3].z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(WORST, state.objective);
}

/* The parabola's optimum is a current that iron may take; the fit goes on to one against the flux, or to more than is rated. */
static void a_fit_that_ends_beyond_an_effects_bounds_is_none(void)
{
    static const double ends[] = {1.0, -1.0, 30.0};
    for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
        prepare();
        takes(P_IRON, 1.0, 300.0);
        takes(P_IRON_LATE, 0.1, 10.0);
        iron_ends = ends[k];
        TEST_ASSERT_TRUE(search(BIT(H_FREE_CURRENT)) == (k == 0 ? BIT(H_FREE_CURRENT) : 0));
        TEST_ASSERT_TRUE(fits > 0);
    }
}

static size_t members(hypothesis_set set)
{
    size_t n = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        n += hypothesis_in(set, h) ? 1 : 0;
    }
    return n;
}

/* In what a search has begun with: once so much was tried, the best of one, two and three, and no more rounds than that and one. */
static void once_spent_the_best_of_each_size_must_do(void)
{
    const hypothesis_set all =
        BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_ANGLE_OFFSET) | BIT(H_INDUCTANCE_A) | BIT(H_VOLTAGE_DELAY_1);
    for (int spent = 0; spent < 2; spent++) {
        prepare();
        takes(P_R, 0.4, 300.0);
        takes(P_PSI, 0.1, 290.0);
        takes(P_THETA_0, 0.1, 280.0);
        takes(P_DL_A, 0.1, 270.0);
        takes(P_U_DELAY_1, 1.0, 260.0);
        data.effort = spent ? 1e9 : 0.0;
        search(all);
        TEST_ASSERT_TRUE(fits >= 3);
        for (size_t k = 0; k < 3; k++) {
            TEST_ASSERT_EQUAL_size_t(k + 1, members(begun[k].set));
        }
        TEST_ASSERT_EQUAL_size_t(members(state.set), spent ? 3 : 5);
        if (spent) {
            TEST_ASSERT_EQUAL_size_t(3, fits);
        }
    }
}

/* All sets of the first round by few rows, the best of them and all later rounds by all. */
static void the_first_round_takes_few_rows(void)
{
    prepare();
    data.rows_fitted = data.rows_max = 5000;
    takes(P_R, 0.4, 300.0);
    takes(P_PSI, 0.1, 290.0);
    const hypothesis_set both = BIT(H_RESISTANCE) | BIT(H_FLUX);
    TEST_ASSERT_TRUE(search(both) == both);
    TEST_ASSERT_EQUAL_size_t(4, fits); /* three sets, and the best by all */
    TEST_ASSERT_EQUAL_size_t(2, looks);
    TEST_ASSERT_TRUE(begun_by[0] < 5000 && look_by[0] == begun_by[0] && begun_by[2] == begun_by[0]);
    TEST_ASSERT_TRUE(begun_by[3] == 5000 && look_by[1] == 5000);
    TEST_ASSERT_TRUE(begun[3].set == both);
    TEST_ASSERT_EQUAL_DOUBLE(best[P_PSI], begun[3].z[P_PSI]);
    TEST_ASSERT_EQUAL_size_t(5000, data.rows_fitted);
    /* A short recording has no more. */
    state = fit_nominal();
    state.objective = WORST;
    data.rows_fitted = data.rows_max = begun_by[0];
    TEST_ASSERT_TRUE(search(both) == both);
    TEST_ASSERT_EQUAL_size_t(3, fits);
    /* A state that holds a cause was fitted by all. */
    data.rows_fitted = data.rows_max = 5000;
    TEST_ASSERT_TRUE(search(both) == both);
    TEST_ASSERT_EQUAL_size_t(5000, look_by[0]);
}

/* What few rows show and all do not is nothing: all have a first round of their own, from where the search began. */
static void what_is_not_left_by_all_rows_is_not_found(void)
{
    prepare();
    data.rows_fitted = data.rows_max = 5000;
    rows_without = 4000;
    takes(P_R, 0.4, 300.0);
    TEST_ASSERT_TRUE(search(BIT(H_RESISTANCE)) == 0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, state.z[P_R]);
    TEST_ASSERT_EQUAL_DOUBLE(WORST, state.objective);
    TEST_ASSERT_EQUAL_size_t(2, looks);
    TEST_ASSERT_EQUAL_size_t(5000, look_by[1]);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, begun[fits - 1].z[P_PSI]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_fit_begins_where_the_parabola_ends);
    RUN_TEST(where_the_model_gives_no_number_a_fit_begins_on_the_way_there);
    RUN_TEST(no_number_near_by_is_given_up);
    RUN_TEST(a_fit_that_ends_beyond_an_effects_bounds_is_none);
    RUN_TEST(once_spent_the_best_of_each_size_must_do);
    RUN_TEST(the_first_round_takes_few_rows);
    RUN_TEST(what_is_not_left_by_all_rows_is_not_found);
    return UNITY_END();
}

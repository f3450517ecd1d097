/*
 * What the tests of what keeps its name share: a session, and what stands in for a recording. The program is linked so that
 * search, fit, certainty and errors are what a test says they are. Each test program includes it once.
 */
#ifndef TESTS_UNIT_CHOOSE_CAUSES_FIXTURE_H
#define TESTS_UNIT_CHOOSE_CAUSES_FIXTURE_H

#include "choose_parabolas.h"
#include "diagnose/choose/causes.h"
#include "diagnose/identify/fit.h"
#include "diagnose/measure/errors.h"
#include "diagnose/measure/runs.h"
#include "diagnose/result.h"
#include "diagnose/weigh/search.h"
#include "wrapped_floor.h"

#include <math.h>
#include <string.h>

#define ZONE BIT(H_SENSOR_ZONE) /* has no name */

/* One-cycle error in percent: of the motor file, and by what factor each coordinate that has left it changes that. */
static double error_of_file, factor[P_COUNT];
static double current_A, inflation;
static double half_width[P_COUNT], scatter[CAUSE_COUNT];
static bool no_memory;

/* The search's proposals, and the arguments of each call. */
enum { MOST_CALLS = 8 };
static hypothesis_set proposed[MOST_CALLS];
static size_t calls;
static hypothesis_set allowed_at[MOST_CALLS];
static double least_at[MOST_CALLS];
/* The sets that were fitted, and R before each fit. */
static size_t fits;
static hypothesis_set set_fitted[MOST_CALLS];
static double R_before[MOST_CALLS];
static bool rough[MOST_CALLS];
/* What a search takes (fit_data's effort). */
static double search_takes;

static session w;

static void prepare(void)
{
    w = (session){.possible = BIT(H_RESISTANCE) | BIT(H_FLUX) | BIT(H_DEAD_TIME) | ZONE,
                  .state = fit_nominal()};
    w.frame.of_least = 1.0;
    w.fitted.frame = &w.frame;
    w.frame.nominal = (averaged_drive){.R_ohm = 1.0, .psi_f_Wb = 1.0, .i_knee_A = 1.0, .fe_tau_s = 1.0};
    for (size_t k = 0; k < SCALE_COUNT; k++) {
        w.frame.scale[k] = 1.0;
    }
    w.nominal = w.state;
    w.nominal.objective = WORST;
    for (size_t k = 0; k < P_COUNT; k++) {
        half_width[k] = 0.0;
        factor[k] = 1.0;
    }
    parabolas_none();
    floor_A = search_takes = 0.0;
    error_of_file = current_A = inflation = 1.0;
    no_memory = false;
    calls = fits = 0;
    memset(proposed, 0, sizeof proposed);
    memset(scatter, 0, sizeof scatter);
}

/* ---- What stands in for a recording ---- */

bool __wrap_search_best(fit_data *d, fit_state *s, hypothesis_set allowed, double nominal_objective,
                        double least, fitted_sets *fitted, evidence_view *seen,
                        const diagnose_teller *teller);
bool __wrap_search_fitted(fit_data *d, const evidence_option *option, hypothesis_set allowed, double most,
                          fit_state *s, double *score);
bool __wrap_fit_refine(fit_data *d, fit_state *s, int iterations);
bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);
bool __wrap_certainty_of(fit_data *d, const fit_state *s, certainty *c);
bool __wrap_evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *seen);
double __wrap_measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive);
double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only);
double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS]);

bool __wrap_search_best(fit_data *d, fit_state *s, hypothesis_set allowed, double nominal_objective,
                        double least, fitted_sets *fitted, evidence_view *seen, const diagnose_teller *teller)
{
    (void)seen;
    (void)fitted;
    (void)teller;
    TEST_ASSERT_TRUE(calls < MOST_CALLS);
    TEST_ASSERT_EQUAL_DOUBLE(WORST, nominal_objective);
    s->set = proposed[calls] & allowed;
    to_bottom(s);
    d->effort += search_takes;
    least_at[calls] = least;
    allowed_at[calls++] = allowed;
    return true;
}

/* No set is fitted: each has the score of the parabola. */
bool __wrap_search_fitted(fit_data *d, const evidence_option *option, hypothesis_set allowed, double most,
                          fit_state *s, double *score)
{
    (void)d;
    (void)option;
    (void)allowed;
    (void)most;
    (void)s;
    *score = INFINITY;
    return true;
}

bool __wrap_fit_refine(fit_data *d, fit_state *s, int iterations)
{
    (void)d;
    (void)iterations;
    TEST_ASSERT_TRUE(fits < MOST_CALLS);
    R_before[fits] = s->z[P_R];
    rough[fits] = false;
    set_fitted[fits++] = s->set;
    to_bottom(s);
    return !no_memory;
}

/* Where so much was tried that a rough fit must do. */
bool __wrap_fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone)
{
    TEST_ASSERT_TRUE(fit_has_spent(d) && aim->enough > 1.0);
    const bool ok = __wrap_fit_refine(d, s, iterations);
    rough[fits - 1] = true;
    *alone = s->objective;
    return ok;
}

bool __wrap_certainty_of(fit_data *d, const fit_state *s, certainty *c)
{
    (void)d;
    (void)s;
    memset(c, 0, sizeof *c);
    c->inflation = inflation;
    for (int k = 0; k < P_COUNT; k++) {
        if (less[k] > 0.0) {
            c->covariance[c->columns][c->columns] = 1.0;
            c->half_width[c->columns] = half_width[k];
            c->column[c->columns++] = k;
        }
    }
    return true;
}

bool __wrap_evidence_look(fit_data *d, const fit_state *s, hypothesis_set allowed, evidence_view *seen)
{
    (void)d;
    TEST_ASSERT_TRUE(allowed == w.possible);
    *seen = (evidence_view){.rows = &rows, .edge = s->edge, .of_least = w.frame.of_least};
    parabolas_seen(s, seen);
    memcpy(seen->scatter, scatter, sizeof scatter);
    return true;
}

double __wrap_measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive)
{
    (void)r;
    double percent = error_of_file;
    percent *= drive->R_ohm != w.frame.nominal.R_ohm ? factor[P_R] : 1.0;
    percent *= drive->psi_f_Wb != w.frame.nominal.psi_f_Wb ? factor[P_PSI] : 1.0;
    percent *= drive->v_dead_V != w.frame.nominal.v_dead_V ? factor[P_V_DEAD] : 1.0;
    percent *= drive->w_dqq != 0.0 ? factor[P_W_DQQ] : 1.0;
    percent *= drive->zone_A != 0.0 ? factor[P_ZONE] : 1.0;
    return percent;
}

double __wrap_measure_current(const diagnose_rows *r, size_t group, bool held_out_only)
{
    (void)r;
    TEST_ASSERT_TRUE(group == MEASURE_ALL && held_out_only);
    return current_A;
}

/* Here the one-cycle error decides. */
double __wrap_measure_open_loop(const diagnose_rows *r, const averaged_drive *drive,
                                double run[ROWS_MAX_GROUPS])
{
    (void)r;
    (void)drive;
    TEST_ASSERT_NULL(run);
    return NAN;
}

/* What is left of a set that the search proposes again and again. */
static hypothesis_set kept_of(hypothesis_set set)
{
    calls = fits = 0;
    w.state = w.nominal;
    for (size_t k = 0; k < MOST_CALLS; k++) {
        proposed[k] = set;
    }
    TEST_ASSERT_TRUE(causes_find(&w));
    return w.state.set;
}

#define KEPT(set)    TEST_ASSERT_TRUE(kept_of(set) == (set))
#define DROPPED(set) TEST_ASSERT_TRUE(kept_of(set) == 0)

#endif

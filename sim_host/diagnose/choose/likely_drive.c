/* The effects of a real drive, fitted together (likely_drive.h). */
#include "likely_drive.h"

#include "diagnose/result.h"
#include "diagnose/weigh/evidence.h"

#include "diagnose/identify/angle_smooth.h"
#include "diagnose/identify/fit.h"
#include "diagnose/identify/modulator_choice.h"
#include "diagnose/identify/row_edges.h"
#include "diagnose/measure/errors.h"
#include "diagnose/measure/glitches.h"
#include "diagnose/measure/runs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 10, LAST_STEPS = 12, JOINS_MOST = 5 };

/* A member may leave if the error grows by no more. */
static const double MEMBER_BRINGS = 1.02;
/* One that joins must reduce the error by more. */
static const double JOIN_BRINGS = 1.05;
/* The open-loop error of two fits of the whole drive is alike if it differs by no more: it is one number of a long simulation. */
static const double ALIKE_OPEN_LOOP = 1.1;
/* Of the error that the search's causes leave, this share may be left. */
static const double BETTER = 0.9;

/* Held-out one-cycle error and open-loop error, percent of the current. */
typedef struct errors {
    double one_cycle, open_loop;
} errors;

static errors errors_of(const session *w, const fit_state *s)
{
    const averaged_drive drive = coordinates_drive(&w->frame, s->z, s->edge);
    return (errors){measure_without_glitches(&w->rows, &drive), measure_open_loop(&w->rows, &drive, NULL)};
}

/* Whether a is no worse than b by more than these factors; what gives no number is worse than all that does. */
static bool within(errors a, errors b, errors factor)
{
    return a.one_cycle <= factor.one_cycle * b.one_cycle &&
           (a.open_loop <= factor.open_loop * b.open_loop || isnan(b.open_loop));
}

static bool join(const session *w, fit_state *s, hypothesis_id h)
{
    if (!hypothesis_in(w->possible, h) || !hypothesis_joins(s->set, h)) {
        return false;
    }
    s->set |= HYPOTHESIS_BIT(h);
    return true;
}

static bool refine(session *w, fit_state *s, int steps)
{
    const fit_aim ranked = fit_ranked(INFINITY);
    return fit_members(&w->fitted, s, steps, &ranked);
}

/*
 * With a dead time. How wide its knee is, by which law, and how much of the ripple an edge sees shape it: a fit that begins at
 * another shape ends in a minimum next to the right one, so it begins at each.
 */
static bool add_dead_time(session *w, fit_state *s)
{
    static const struct {
        edge_law law;
        double knee, ripple; /* share of the rated peak current; share of the ripple */
    } start[] = {{EDGE_CHARGED, 0.02, 0.7},
                 {EDGE_CLIPPED, 0.02, 0.0},
                 {EDGE_CLIPPED, 0.06, 0.0},
                 {EDGE_CLIPPED, 0.15, 0.0}};
    if (!join(w, s, H_DEAD_TIME)) {
        return true;
    }
    const fit_state from = *s;
    double least = INFINITY;
    for (size_t k = 0; k < sizeof start / sizeof *start; k++) {
        fit_state trial = from;
        trial.edge = start[k].law;
        trial.z[P_KNEE] = log(start[k].knee * w->frame.i_rated_peak_A / w->frame.nominal.i_knee_A);
        trial.z[P_RIPPLE] = start[k].ripple;
        if (!refine(w, &trial, STEPS)) {
            return false;
        }
        if (trial.objective < least) {
            least = trial.objective;
            *s = trial;
        }
    }
    return true;
}

/* When the legs switch is a guess without duties: by the modulator under which the dead time leaves least. */
static bool choose_modulator(session *w, fit_state *s)
{
    bool changed = false;
    if (w->rows.recording->duty[0] || !hypothesis_in(s->set, H_DEAD_TIME)) {
        return true;
    }
    return modulator_choose(&w->fitted, s, EDGES_BY_DEAD_TIME, 0.0, &changed) &&
           (!changed || refine(w, s, STEPS));
}

static bool fit_in_order(session *w, fit_state *s)
{
    static const hypothesis_id machine[] = {H_RESISTANCE, H_SALIENCY, H_FLUX};
    static const hypothesis_id turns[] = {H_ANGLE_HARMONIC_1, H_ANGLE_HARMONIC_2};
    join(w, s, H_ANGLE_OFFSET);
    bool ok = refine(w, s, STEPS);
    for (size_t k = 0; k < sizeof machine / sizeof *machine; k++) {
        join(w, s, machine[k]);
    }
    ok = ok && refine(w, s, STEPS);
    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        join(w, s, turns[k]);
    }
    return ok && refine(w, s, STEPS) && add_dead_time(w, s) && choose_modulator(w, s);
}

/* The angle smoothed over as many rows as lower the errors most, if by enough. */
static bool smooth_angle(session *w, fit_state *s, errors *e)
{
    static const size_t half[] = {2, 4, 7, 12};
    diagnose_rows *r = &w->rows;
    const averaged_drive drive = coordinates_drive(&w->frame, s->z, s->edge);
    size_t chosen = 0;
    errors best = {e->one_cycle / MEMBER_BRINGS, e->open_loop};
    r->rough = malloc(r->rows * sizeof *r->rough);
    if (!r->rough) {
        return false;
    }
    memcpy(r->rough, r->row, r->rows * sizeof *r->rough);
    for (size_t k = 0; k < sizeof half / sizeof *half; k++) {
        if (!angle_smooth(&w->fitted, r->rough, &drive, half[k])) {
            return false;
        }
        const errors now = errors_of(w, s);
        if (now.one_cycle < best.one_cycle && now.open_loop <= MEMBER_BRINGS * e->open_loop) {
            best = now;
            chosen = half[k];
        }
    }
    if (!angle_smooth(&w->fitted, r->rough, &drive, chosen)) {
        return false;
    }
    r->smooth_half = chosen;
    if (chosen == 0) {
        free(r->rough);
        r->rough = NULL;
        return true;
    }
    session_trace(w, "  angle smoothed over %zu rows to either side\n", chosen);
    const bool ok = refine(w, s, STEPS);
    *e = errors_of(w, s);
    return ok;
}

/* As it was before. */
static bool roughen_angle(session *w)
{
    diagnose_rows *r = &w->rows;
    if (!r->rough) {
        return true;
    }
    const bool ok = angle_smooth(&w->fitted, r->rough, &w->frame.nominal, 0);
    free(r->rough);
    r->rough = NULL;
    r->smooth_half = 0;
    return ok;
}

static void say(const session *w, const char *what, const fit_state *s, errors e)
{
    char words[256];
    session_trace(w, "  likely effects %s: %s: one cycle %.2f %%, open loop %.2f %%\n", what,
                  evidence_words(s->set, words, sizeof words), e.one_cycle, e.open_loop);
}

/* What the parabola at the state says that a set leaves. */
static double cost_of(const evidence_view *view, const fit_state *s, hypothesis_set set)
{
    evidence_option option;
    return evidence_cost(view, s, set, &option) ? option.cost : INFINITY;
}

/* A hypothesis by which the state may be extended, and what it promises. */
typedef struct promise {
    hypothesis_id h;
    double cost;
} promise;

static int by_cost(const void *x, const void *y)
{
    const promise *a = x;
    const promise *b = y;
    return a->cost < b->cost ? -1 : a->cost > b->cost;
}

/* Effects of the sensors and the magnet that may join; no delay and no shape of the flux, which take up what others leave. */
static bool may_join(const session *w, hypothesis_set set, hypothesis_id h)
{
    static const hypothesis_id some[] = {H_GAIN_MISMATCH,   H_CURRENT_GAIN,  H_CURRENT_OFFSET,
                                         H_VOLTAGE_GAIN,    H_EMF_HARMONICS, H_ANGLE_HARMONIC_2P,
                                         H_ANGLE_HARMONIC_P};
    bool listed = false;
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        listed = listed || some[k] == h;
    }
    return listed && hypothesis_in(w->possible, h) && hypothesis_joins(set, h);
}

/* One more effect, if it lowers both errors; *joined: whether one did. */
static bool extend(session *w, fit_state *s, errors *e, bool *joined)
{
    evidence_view *view = &w->view;
    promise list[H_COUNT];
    size_t n = 0;
    *joined = false;
    if (!evidence_look(&w->fitted, s, w->possible, view)) {
        return false;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (may_join(w, s->set, h)) {
            list[n++] = (promise){h, cost_of(view, s, s->set | HYPOTHESIS_BIT(h))};
        }
    }
    qsort(list, n, sizeof *list, by_cost);
    for (size_t k = 0; k < n && k < 2 && isfinite(list[k].cost) && !*joined; k++) {
        fit_state trial = *s;
        trial.set |= HYPOTHESIS_BIT(list[k].h);
        if (!refine(w, &trial, STEPS)) {
            return false;
        }
        const errors now = errors_of(w, &trial);
        if (JOIN_BRINGS * now.one_cycle <= e->one_cycle && now.open_loop <= e->open_loop) {
            *s = trial;
            *e = now;
            *joined = true;
            say(w, "extended", s, now);
        }
    }
    return true;
}

/* A member that no drive has like this. */
static bool is_no_value(const session *w, const fit_state *s, hypothesis_id h)
{
    return hypothesis_size(h, s->z) < w->frame.of_least * hypothesis_table[h].least ||
           hypothesis_at_bound(&w->frame, h, s->z);
}

static void leave(fit_state *s, hypothesis_id h, hypothesis_set possible)
{
    s->set &= ~HYPOTHESIS_BIT(h);
    if (h == H_SALIENCY && hypothesis_in(possible, H_INDUCTANCE)) {
        hypothesis_leave_mean(h, s->z);
        s->set |= HYPOTHESIS_BIT(H_INDUCTANCE);
        return;
    }
    hypothesis_copy(h, hypothesis_nominal, s->z);
}

/* One member less: *left is set if one went. */
static bool shrink(session *w, fit_state *s, errors best, bool *left)
{
    evidence_view *view = &w->view;
    promise list[H_COUNT];
    size_t n = 0;
    *left = false;
    if (!evidence_look(&w->fitted, s, w->possible, view)) {
        return false;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(s->set, h)) {
            const double cost = cost_of(view, s, s->set & ~HYPOTHESIS_BIT(h));
            list[n++] = (promise){h, is_no_value(w, s, h) ? -INFINITY : cost};
        }
    }
    qsort(list, n, sizeof *list, by_cost);
    for (size_t k = 0; k < n && k < 3 && !*left; k++) {
        fit_state trial = *s;
        leave(&trial, list[k].h, w->possible);
        if (!refine(w, &trial, STEPS)) {
            return false;
        }
        const errors now = errors_of(w, &trial);
        if (isinf(list[k].cost) || within(now, best, (errors){MEMBER_BRINGS, MEMBER_BRINGS})) {
            *s = trial;
            *left = true;
            say(w, "without one", s, now);
        }
    }
    return true;
}

/* Whether the fit explains most of the error, and more than a sparse search, or no less than the other fit of the whole drive. */
static bool is_better(const session *w, const fit_state *s, errors e, errors found)
{
    const errors factor = w->way == SESSION_WHOLE_DRIVE ? (errors){MEMBER_BRINGS, ALIKE_OPEN_LOOP}
                                                        : (errors){BETTER, MEMBER_BRINGS};
    return s->set != 0 && !isnan(e.open_loop) && within(e, found, factor) &&
           session_explains_most(w, s, e.one_cycle);
}

/* From the motor file's values to the whole drive in *s; false: out of memory. *taken: it is better than what the search found. */
static bool fit_whole(session *w, fit_state *s, bool *taken)
{
    const errors found = errors_of(w, &w->state);
    bool goes_on = true;
    if (!fit_in_order(w, s)) {
        return false;
    }
    if (measure_glitches(&w->fitted, s) > 0 && !refine(w, s, STEPS)) {
        return false;
    }
    errors e = errors_of(w, s);
    say(w, "fitted", s, e);
    if (!smooth_angle(w, s, &e)) {
        return false;
    }
    say(w, "fitted again", s, e);
    if (!is_better(w, s, e, found)) {
        return true;
    }
    for (int n = 0; goes_on && n < JOINS_MOST; n++) {
        if (!extend(w, s, &e, &goes_on)) {
            return false;
        }
    }
    for (goes_on = true; goes_on && s->set != 0;) {
        if (!shrink(w, s, e, &goes_on)) {
            return false;
        }
    }
    const fit_aim kept = fit_kept(INFINITY);
    if (!fit_members(&w->fitted, s, LAST_STEPS, &kept)) {
        return false;
    }
    e = errors_of(w, s);
    *taken = is_better(w, s, e, found);
    say(w, *taken ? "taken" : "not taken", s, e);
    return true;
}

bool likely_drive_fit(session *w)
{
    if (!session_leaves(w, DIAGNOSIS_FLOOR_TOLERANCE)) {
        return true;
    }
    diagnose_rows *r = &w->rows;
    unsigned char *outlier = malloc(r->rows + 1);
    const modulator own = r->modulator;
    fit_state s = w->nominal;
    bool taken = false;
    bool ok = outlier != NULL;
    w->view.stands = false;
    if (ok) {
        /* What a search that led nowhere took for glitches, and for the modulator, is forgotten. */
        memcpy(outlier, r->outlier, r->rows);
        memset(r->outlier, 0, r->rows);
        rows_fill_edges(r, w->frame.motor, MODULATOR_MIN_MAX);
        w->fitted.pooled = true;
        ok = fit_whole(w, &s, &taken);
        w->fitted.pooled = false;
    }
    if (ok && taken) {
        w->state = s;
        w->way = SESSION_LIKELY_DRIVE;
        w->more_left = false;
        w->minor = w->undecided = 0;
        memset(w->scale, 0, sizeof w->scale);
        ok = certainty_of(&w->fitted, &w->state, &w->certainty);
    } else if (ok) {
        ok = roughen_angle(w);
        rows_fill_edges(r, w->frame.motor, own);
        memcpy(r->outlier, outlier, r->rows);
        w->view.stands = false;
    }
    free(outlier);
    return ok;
}

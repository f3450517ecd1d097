/* The best set of hypotheses, round by round (search.h). */
#include "search.h"

#include "fitted_sets.h"
#include "map_choice.h"
#include "tolerance.h"

#include "diagnose/identify/branch_choice.h"
#include "diagnose/identify/edge_choice.h"
#include "diagnose/identify/fit.h"
#include "diagnose/identify/revolution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SEARCH_ROUNDS = 5,
    FULL_SIZE = 3,    /* all sets up to this size are compared */
    LARGEST_SIZE = 5, /* larger ones grow from the best */
    KEPT = 24,        /* sets that grow */
    REFINED = 3,      /* sets that are fitted without linearisation per round */
    REFINE_STEPS = 5,
    FEW_ROWS = 2500 /* enough to tell the best set of the first round */
};

/* How much worse than the present set a set may look under linearisation and still be tried. */
static const double SLACK = 30.0;

/* How near to where it was seen from a fit of an option begins at the most. */
static const double LEAST_SHARE = 0.1;

/* What another round of the same set, with stretches turned, must have brought to be followed by one more: if the turns of two
 * orders have the same effect, they alternate. */
static const double TURN_BRINGS = 10.0;

static int by_score(const void *x, const void *y)
{
    const evidence_option *a = x;
    const evidence_option *b = y;
    return a->score < b->score ? -1 : a->score > b->score;
}

/*
 * A member that the others do without, by their own unbounded optimum, is there only because columns lean on
 * one another (flux, voltage gain and current gain together move along a line that changes nothing).
 */
static bool every_member_pays(const evidence_view *view, const fit_state *s, const evidence_option *option)
{
    for (hypothesis_set left = option->set; left != 0; left &= left - 1) {
        evidence_option without;
        const hypothesis_set rest = option->set & ~HYPOTHESIS_BIT(hypothesis_first(left));
        evidence_cost(view, s, rest, &without);
        if (without.cost + evidence_penalty(view, rest) <=
            option->cost + evidence_penalty(view, option->set)) {
            return false;
        }
    }
    return true;
}

typedef struct enumeration {
    const evidence_view *view;
    const fit_state *state;
    hypothesis_set allowed;
    evidence_option list[KEPT + 1];
    size_t listed;
    evidence_option of_size[FULL_SIZE]; /* the best of one, two, three; set 0 if there is none */
} enumeration;

/* Keeps the best options in a sorted list of at most KEPT. */
static void keep(enumeration *e, const evidence_option *option)
{
    evidence_option *list = e->list;
    size_t *n = &e->listed;
    size_t size = 0;
    for (hypothesis_set rest = option->set; rest != 0; rest &= rest - 1) {
        size++;
    }
    if (size >= 1 && size <= FULL_SIZE) {
        evidence_option *best = &e->of_size[size - 1];
        if ((best->set == 0 || by_score(option, best) < 0) && every_member_pays(e->view, e->state, option)) {
            *best = *option;
        }
    }
    if ((*n == KEPT && by_score(option, &list[KEPT - 1]) >= 0) ||
        !every_member_pays(e->view, e->state, option)) {
        return;
    }
    for (size_t k = 0; k < *n; k++) {
        if (list[k].set == option->set) {
            return;
        }
    }
    if (*n < KEPT) {
        list[(*n)++] = *option;
    } else {
        list[KEPT - 1] = *option;
    }
    qsort(list, *n, sizeof *list, by_score);
}

static void enumerate(enumeration *e, hypothesis_set set, hypothesis_id from, int more)
{
    evidence_option option;
    if (evidence_cost(e->view, e->state, set, &option)) {
        keep(e, &option);
    }
    for (hypothesis_id h = from; more > 0 && h < H_COUNT; h++) {
        if ((e->allowed & HYPOTHESIS_BIT(h)) && hypothesis_joins(set, h)) {
            enumerate(e, set | HYPOTHESIS_BIT(h), h + 1, more - 1);
        }
    }
}

static void grow(enumeration *e)
{
    for (int size = FULL_SIZE; size < LARGEST_SIZE; size++) {
        evidence_option seed[KEPT];
        size_t seeds = e->listed;
        memcpy(seed, e->list, seeds * sizeof *seed);
        for (size_t k = 0; k < seeds; k++) {
            for (hypothesis_id h = 0; h < H_COUNT; h++) {
                evidence_option option;
                hypothesis_set set = seed[k].set | HYPOTHESIS_BIT(h);
                if ((e->allowed & HYPOTHESIS_BIT(h)) && hypothesis_joins(seed[k].set, h) &&
                    evidence_cost(e->view, e->state, set, &option)) {
                    keep(e, &option);
                }
            }
        }
    }
}

void search_take_out(const fit_data *d, fit_state *s, hypothesis_id h, hypothesis_set allowed)
{
    const double of_least = d->frame->of_least;
    s->set &= ~HYPOTHESIS_BIT(h);
    if (h == H_COMPENSATED && hypothesis_in(allowed, H_DEAD_TIME) &&
        hypotheses_count(HYPOTHESIS_BIT(H_DEAD_TIME), s->z, of_least)) {
        s->set |= HYPOTHESIS_BIT(H_DEAD_TIME);
        edge_of_set(d, s);
        return;
    }
    if (h != H_INDUCTANCE && (hypothesis_table[h].holds & HOLDS_INDUCTANCE) != 0) {
        hypothesis_leave_mean(h, s->z);
        if (hypothesis_in(allowed, H_INDUCTANCE) &&
            hypotheses_count(HYPOTHESIS_BIT(H_INDUCTANCE), s->z, of_least)) {
            s->set |= HYPOTHESIS_BIT(H_INDUCTANCE);
            return;
        }
    }
    last_digits_keep(h, s->z);
}

bool search_drop_small(const fit_data *d, fit_state *s, hypothesis_set allowed)
{
    const hypothesis_set before = s->set;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(s->set, h) && !hypotheses_count(HYPOTHESIS_BIT(h), s->z, d->frame->of_least)) {
            search_take_out(d, s, h, allowed);
        }
    }
    return s->set != before;
}

/* Puts what an option fits so much of the way to where its quadratic form has its optimum; the rest is there at once. */
static void go_towards(const evidence_option *option, const fit_state *from, double share, double z[P_COUNT])
{
    bool fitted[P_COUNT] = {false};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(option->set, h)) {
            hypothesis_mark(h, fitted);
        }
        for (size_t k = 0; hypothesis_in(option->set, h) && k < hypothesis_table[h].fixed; k++) {
            fitted[hypothesis_table[h].column[k]] = false;
        }
    }
    memcpy(z, option->z, sizeof option->z);
    for (size_t k = 0; share < 1.0 && k < P_COUNT; k++) {
        z[k] = fitted[k] ? from->z[k] + share * (z[k] - from->z[k]) : z[k];
    }
}

/*
 * An option fitted without linearisation, from where its quadratic form has its optimum, or from the way there if the model gives no
 * number at its end, as where a flux map bends back. *alone: the objective, NAN if an effect has a sign or size that it cannot have.
 * *worth: as in fitted_set.
 */
static bool fit_option(fit_data *d, const evidence_option *option, hypothesis_set allowed, double most,
                       fit_state *trial, double *alone, double *worth)
{
    const fit_aim ranked = fit_ranked(most);
    const fit_state from = *trial;
    *alone = NAN;
    for (double share = 1.0; isnan(*alone) && share > LEAST_SHARE; share *= 0.5) {
        *trial = from;
        trial->set = option->set;
        go_towards(option, &from, share, trial->z);
        edge_of_set(d, trial);
        coordinates_bound(d->frame, trial->z);
        if (!fit_refine_within(d, trial, REFINE_STEPS, &ranked, alone)) {
            return false;
        }
    }
    while (*alone <= most && search_drop_small(d, trial, allowed)) {
        if (!fit_refine_within(d, trial, REFINE_STEPS, &ranked, alone)) {
            return false;
        }
    }
    if (!hypotheses_physical(trial->set, trial->z)) {
        *alone = NAN; /* the way there led beyond its bounds */
    }
    return !(*alone <= most) || tolerance_of_state(d, trial, worth);
}

/* `worth`: reduction by the tolerances of its laws. */
static double state_score(const evidence_view *view, const fit_state *s, double worth)
{
    return s->objective - worth + evidence_price(view, s->set, s->z) + last_digits_unusual(s->set, s->z);
}

/* The same without a view. False: out of memory. */
static bool score_of_fit(const fit_data *d, const fit_state *s, double worth, double *score)
{
    evidence_view *view = calloc(1, sizeof *view);
    if (view) {
        view->rows = d->rows;
        view->edge = s->edge;
        view->of_least = d->frame->of_least;
        *score = state_score(view, s, worth);
    }
    free(view);
    return view != NULL;
}

bool search_score(fit_data *d, const fit_state *s, double *score)
{
    double worth = 0.0;
    return tolerance_of_state(d, s, &worth) && score_of_fit(d, s, worth, score);
}

bool search_fitted(fit_data *d, const evidence_option *option, hypothesis_set allowed, double most,
                   fit_state *s, double *score)
{
    double alone;
    double worth = 0.0;
    *score = INFINITY;
    return fit_option(d, option, allowed, most, s, &alone, &worth) &&
           (!(alone <= most) || score_of_fit(d, s, worth, score));
}

/* Fitting an option is what takes the time. */
static void tell_option(const diagnose_teller *teller, int round, const evidence_option *option)
{
    char words[256];
    if (teller->shown) {
        progress_say(teller->shown, "diagnose: round %d, trying %s", round + 1,
                     evidence_words(option->set, words, sizeof words));
    }
}

/*
 * The objective that an option's own coordinates must reach, compared with the best so far. Whoever stays behind that by a
 * quarter of its reduction of the motor file's, and ten times the reduction by its tolerance, does not make up for it by its own.
 */
static double most_of(double nominal, const fit_state *best, double by_digits)
{
    if (best->set == 0) {
        return INFINITY;
    }
    return best->objective + 0.25 * (nominal - best->objective) + 10.0 * by_digits;
}

/* What a search looks at and by. */
typedef struct searching {
    fit_data *d;
    hypothesis_set allowed;
    double nominal; /* objective of the motor file's model */
    double least;
    fitted_sets *fitted;
    evidence_view *view;
    enumeration *e;
    const diagnose_teller *teller;
} searching;

/* A round's options against the best of them so far. */
typedef struct contest {
    const searching *by;
    fit_state start; /* from which they are fitted */
    int round;
    double score, by_digits; /* of the best so far */
} contest;

static void trace_option(const contest *c, const evidence_option *option, const fit_state *trial,
                         const char *how, double score)
{
    char words[256];
    if (c->by->teller->trace) {
        fprintf(c->by->teller->trace, "  round %d: %-60s ", c->round,
                evidence_words(option->set, words, sizeof words));
        if (isnan(option->score)) {
            fprintf(c->by->teller->trace, "%-19s", "in its place");
        } else {
            fprintf(c->by->teller->trace, "linear %10.1f  ", option->score);
        }
        fprintf(c->by->teller->trace, "%s %12.1f%s%s\n", how, score, trial->set != option->set ? " as " : "",
                trial->set != option->set ? evidence_words(trial->set, words, sizeof words) : "");
    }
}

/* An option fitted; *s, if it is better. */
static bool try_option(fit_state *s, const evidence_option *option, contest *c)
{
    const fitted_set *before =
        c->round > 0 ? fitted_sets_find(c->by->fitted, option->set, c->by->e->allowed) : NULL;
    fit_state trial = before ? before->state : c->start;
    double worth = before ? before->worth : 0.0;
    const double most = most_of(c->by->nominal, s, c->by_digits);
    double alone = trial.objective;
    if (!before) {
        tell_option(c->by->teller, c->round, option);
        if (!fit_option(c->by->d, option, c->by->e->allowed, most, &trial, &alone, &worth)) {
            return false;
        }
        if (c->round > 0 && alone <= most) {
            fitted_sets_keep(c->by->fitted, option->set, &trial, worth);
        }
    }
    const double score = state_score(c->by->e->view, &trial, worth);
    trace_option(c, option, &trial, before ? "known " : (alone <= most ? "fitted" : "given up"), score);
    if (alone <= most && score < c->score) {
        *s = trial;
        c->by_digits = fmax(alone - trial.objective, 0.0);
        c->score = score;
    }
    return true;
}

/*
 * An effect without a name that won together with others may hold the place of a cause that does the same: with its freedom it looks better
 * from afar, where no law's shape is fitted yet. That cause is tried in its place.
 */
static bool try_named(fit_state *s, contest *c)
{
    const fit_state best = *s;
    c->start = best;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *decoy = &hypothesis_table[h];
        if (!hypothesis_in(best.set, h) || hypothesis_cause(h)->named || decoy->holds == 0) {
            continue;
        }
        for (hypothesis_id other = 0; other < H_COUNT; other++) {
            const hypothesis_set rest = best.set & ~HYPOTHESIS_BIT(h);
            if (hypothesis_in(c->by->e->allowed, other) && hypothesis_cause(other)->named &&
                (hypothesis_table[other].holds & decoy->holds) != 0 && hypothesis_joins(rest, other)) {
                evidence_option named = {.set = rest | HYPOTHESIS_BIT(other), .score = NAN};
                memcpy(named.z, best.z, sizeof named.z);
                hypothesis_copy(h, hypothesis_nominal, named.z);
                if (!try_option(s, &named, c)) {
                    return false;
                }
            }
        }
    }
    return true;
}

/* One round: the promising options fitted, *s the best. */
static bool try_options(const searching *by, fit_state *s, int round)
{
    const enumeration *e = by->e;
    const fit_state start = *s;
    contest c = {.by = by, .start = start, .round = round, .score = state_score(e->view, s, e->view->worth)};
    evidence_option own;
    evidence_cost(e->view, &start, start.set, &own);
    const double own_cost = own.cost + evidence_penalty(e->view, start.set);
    hypothesis_set tried[FULL_SIZE + REFINED] = {0};
    size_t n = 0;
    for (size_t k = 0; k < FULL_SIZE + REFINED; k++) {
        /* First the best of each size: while the state is a bad fit, larger sets win by soaking up what is
         * not theirs. */
        const evidence_option *option = k < FULL_SIZE ? &e->of_size[k] : &e->list[k - FULL_SIZE];
        bool known = option->set == 0 || (k >= FULL_SIZE && k - FULL_SIZE >= e->listed) ||
                     (round > 0 && option->set == start.set);
        for (size_t j = 0; j < n; j++) {
            known = known || tried[j] == option->set;
        }
        /* Once the state is a fit, its own set's quadratic form is exact, and what does worse there need not
         * be fitted. */
        if (known ||
            (round > 0 && option->cost + evidence_penalty(e->view, option->set) > own_cost + SLACK)) {
            continue;
        }
        /* So much was tried that the best of each size must do. */
        if (k >= FULL_SIZE && fit_has_spent(by->d)) {
            break;
        }
        tried[n++] = option->set;
        if (!try_option(s, option, &c)) {
            return false;
        }
    }
    return try_named(s, &c);
}

/* Looks at all sets from the state and fits the promising ones; *s: the best. */
static bool try_sets(const searching *by, fit_state *s, int round)
{
    if (!evidence_look(by->d, s, by->allowed, by->view)) {
        return false;
    }
    by->view->explained = fmax(by->nominal - s->objective, 0.0);
    by->view->least = by->least;
    enumeration *e = by->e;
    memset(e, 0, sizeof *e);
    e->view = by->view;
    e->state = s;
    e->allowed = by->allowed | (s->set & (HYPOTHESIS_BIT(H_IRON_1) | HYPOTHESIS_BIT(H_IRON_2)));
    enumerate(e, 0, 0, FULL_SIZE);
    grow(e);
    return try_options(by, s, round);
}

/*
 * The first round, from the motor file's model, by few rows: most of the sets that it fits are wrong, and it needs only to know which is
 * best. That one is fitted by all rows. *s stays if none is better, or the model gives no number there.
 */
static bool try_sets_by_few_rows(const searching *by, fit_state *s)
{
    const fit_state start = *s;
    searching few = *by;
    fit_data_select(by->d, FEW_ROWS);
    fit_noise(by->d, s);
    few.nominal = s->objective;
    const bool ok = try_sets(&few, s, 0);
    fit_data_select(by->d, by->d->rows_max);
    by->view->stands = false;
    double alone = NAN;
    double worth;
    evidence_option found = {.set = s->set};
    memcpy(found.z, s->z, sizeof found.z);
    if (ok && s->set != 0 && !fit_option(by->d, &found, by->allowed, INFINITY, s, &alone, &worth)) {
        return false;
    }
    if (isnan(alone)) {
        *s = start;
    }
    return ok;
}

bool search_best(fit_data *d, fit_state *s, hypothesis_set allowed, double nominal_objective, double least,
                 fitted_sets *fitted, evidence_view *view, const diagnose_teller *teller)
{
    const searching by = {
        d, allowed, nominal_objective, least, fitted, view, calloc(1, sizeof(enumeration)), teller};
    edge_contest edges = {.apart = 0.0};
    bool ok = by.e != NULL;
    /* A state that holds causes is a fit already: what looks worse from there is not tried. */
    for (int round = s->set ? 1 : 0; ok && round < SEARCH_ROUNDS && (round < 2 || !fit_has_spent(d));
         round++) {
        const double entered = s->objective;
        bool turned = false;
        ok =
            edge_choose(d, s) && branch_choose(d, s) && revolution_align(d, s, d->frame->pole_pairs, &turned);
        view->stands = view->stands && !turned;
        ok = ok && (!turned || fit_refine(d, s, REFINE_STEPS));
        if (turned || s->edge != fitted->edge) {
            fitted_sets_forget(fitted, s->edge);
        }
        const hypothesis_set before = s->set;
        ok = ok && (round > 0 || d->rows_fitted <= FEW_ROWS || try_sets_by_few_rows(&by, s)) &&
             (s->set != before || try_sets(&by, s, round)) && map_choose(d, s, allowed, REFINE_STEPS);
        if (s->set == before && !(turned && s->objective < entered - TURN_BRINGS)) {
            break;
        }
        ok = ok && (!hypothesis_in(s->set, H_DEAD_TIME) || edge_revise(d, s, REFINE_STEPS, &edges));
    }
    free(by.e);
    return ok;
}

/* Shares of the evidence (probability.h). */
#include "probability.h"

#include "search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct tally {
    const evidence_view *view;
    const fit_state *state;
    hypothesis_set possible;
    fit_data *d; /* NULL: by the parabola alone */
    rival_fits *fits;
    bool no_memory;
    double best, inflation;
    double all;
    double of_cause[CAUSE_COUNT];
    double contained[CAUSE_COUNT]; /* by another that contains it */
    double without[CAUSE_COUNT];   /* the likeliest set without it */
} tally;

/* The set that was fitted is one whatever the parabola about it says: the optimum of causes that trade may lie where one of
 * them is too small for a name. */
static double score_of(const tally *t, hypothesis_set set)
{
    evidence_option option;
    if (set == t->state->set) {
        return t->best;
    }
    return evidence_cost(t->view, t->state, set, &option) ? option.score : INFINITY;
}

/* Counts from here on by this view; returns the cost of the state's own set there. */
static double look_by(tally *t, const evidence_view *view)
{
    const hypothesis_set set = t->state->set;
    evidence_option own;
    t->view = view;
    evidence_cost(view, t->state, set, &own);
    t->best = own.cost + evidence_price(view, set, own.z);
    return own.cost;
}

/* A set whose flux map holds a member's saliency is no other explanation of it. */
static bool contains_one_of(const tally *t, hypothesis_set set, cause_id cause)
{
    for (hypothesis_id member = 0; member < H_COUNT; member++) {
        for (hypothesis_id h = 0;
             hypothesis_in(t->state->set, member) && hypothesis_table[member].cause == cause && h < H_COUNT;
             h++) {
            if (hypothesis_in(set, h) && hypothesis_contains(h, member)) {
                return true;
            }
        }
    }
    return false;
}

/* The score of a set after its fit; NAN if too many were fitted. */
static double fitted_score(tally *t, hypothesis_set set)
{
    rival_fits *f = t->fits;
    size_t k = 0;
    while (k < f->count && f->set[k] != set) {
        k++;
    }
    if (k == RIVALS_FITTED) {
        return NAN;
    }
    if (k == f->count) {
        fit_state s = *t->state;
        evidence_option option;
        evidence_cost(t->view, t->state, set, &option);
        if (set == s.set) {
            memcpy(option.z, s.z, sizeof option.z);
        }
        const double most = s.objective + evidence_penalty(t->view, s.set);
        t->no_memory = !search_fitted(t->d, &option, t->possible, most, &s, &f->score[k]) || t->no_memory;
        if (s.set != set && set != t->state->set) {
            f->score[k] = INFINITY; /* too small a member: a set that is counted by itself */
        }
        f->set[k] = set;
        f->count++;
    }
    return f->score[k];
}

/*
 * By how much a set's score is above that of the state's own. The parabola about the state is wrong far from it: an offset of a current
 * acts through R, so to the parabola it is a resistance of twice the value. A set that it makes likelier is therefore fitted.
 */
static double behind(tally *t, hypothesis_set set)
{
    const double by_parabola = score_of(t, set) - t->best;
    if (t->d == NULL || !(by_parabola < 0.0)) {
        return by_parabola;
    }
    const double own = fitted_score(t, t->state->set);
    const double score = fitted_score(t, set);
    return own < INFINITY && !isnan(score) ? score - own : by_parabola;
}

static void count(tally *t, hypothesis_set set)
{
    const double weight = exp(-0.5 * behind(t, set) / t->inflation);
    t->all += weight;
    for (cause_id cause = 0; cause < CAUSE_COUNT; cause++) {
        if (hypotheses_hold(set, cause)) {
            t->of_cause[cause] += weight;
            continue;
        }
        t->without[cause] = fmax(t->without[cause], weight);
        t->contained[cause] += contains_one_of(t, set, cause) ? weight : 0.0;
    }
}

/* The set, and the set with one more that is not the state's own again. */
static void count_about(tally *t, hypothesis_set set, hypothesis_set possible)
{
    count(t, set);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(possible, h) && !hypothesis_in(t->state->set, h) && hypothesis_joins(set, h)) {
            count(t, set | HYPOTHESIS_BIT(h));
        }
    }
}

bool probability_of(const evidence_view *view, const fit_state *s, hypothesis_set possible, double inflation,
                    fit_data *d, rival_fits *fits, standing of[H_COUNT])
{
    tally t = {.state = s, .inflation = inflation, .d = d, .fits = fits, .possible = possible};
    if (d != NULL && (fits->possible != possible || !evidence_is_same(&fits->of, s))) {
        fits->of = *s;
        fits->possible = possible;
        fits->count = 0;
    }
    evidence_view *held = malloc(sizeof *held);
    look_by(&t, view);
    count_about(&t, s->set, possible);
    for (hypothesis_id h = 0; held && h < H_COUNT; h++) {
        of[h].against = 0.0;
        if (hypothesis_in(s->set, h)) {
            const hypothesis_set rest = s->set & ~HYPOTHESIS_BIT(h);
            evidence_option without;
            evidence_hold(view, h, held);
            const double own_cost = look_by(&t, held);
            evidence_cost(held, s, rest, &without);
            of[h].against = without.cost - own_cost;
            count_about(&t, rest, possible);
        }
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const cause_id cause = hypothesis_table[h].cause;
        of[h].alone = t.all > 0.0 ? t.of_cause[cause] / t.all : 0.0;
        of[h].probability = t.all > 0.0 ? (t.of_cause[cause] + t.contained[cause]) / t.all : 0.0;
        of[h].rival = t.without[cause];
    }
    const bool ok = held != NULL && !t.no_memory;
    free(held);
    return ok;
}

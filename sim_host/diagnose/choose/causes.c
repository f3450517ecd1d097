/* Search and prune in turn until all that stays is certain (causes.h). */
#include "causes.h"

#include "diagnose/identify/fit.h"
#include "diagnose/measure/errors.h"
#include "diagnose/weigh/confusion.h"
#include "diagnose/weigh/evidence.h"
#include "diagnose/weigh/probability.h"
#include "diagnose/weigh/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * A cause is named when its posterior is high: 0.99 against the set without it (here in -2 log of odds: by what it reduces the cost,
 * by how much wider than white noise the scores scatter, less what it pays), and more likely than not among all sets about
 * the one chosen, or in the likeliest of these, as of causes that trade each may be less likely than not (probability.h).
 * And when the posterior that it exceeds its `least` is: 0.975, one half width of its size.
 */
static const double ODDS_OF_NAMED = 9.2;
static const double LIKELY = 0.5;

/* If no hypothesis explains the residual structure, a cause may be a part of that: the least share of what is
 * left. */
static const double LEAST_SHARE_OF_REST = 0.05;

/* A cause that reduces the cost so many times as much as the effects without a name is none of their parts. */
static const double FAR_MORE = 4.0;

/*
 * A flux map has terms enough to take any shape a little. One that differs by so much between operating points and leaves so much
 * of the held-out error is none. Of development recordings a true one differs by 3 to 15 % (those of motulator's machines, which no
 * polynomial holds, by 3 to 44 %, and leave a tenth), one that stands for an angle's error by 44 to 84 %, and leaves 60 to 76 %.
 */
static const double ONE_MAP = 0.3;
static const double MOST_LEFT = 0.5;

enum { PRUNE_STEPS = 12, ROUGH_STEPS = 5 };

/* An error in noise floors; 0 if there is no noise to measure it by. */
static double in_floors(double floor, double percent)
{
    return floor > 0.0 ? percent / floor : 0.0;
}

/* Whether another cause would do as well in h's place. */
static bool is_open(const session *w, double own_cost, hypothesis_id h)
{
    for (hypothesis_id other = 0; other < H_COUNT; other++) {
        if ((w->possible & HYPOTHESIS_BIT(other)) &&
            confusion_of(&w->view, &w->state, own_cost, h, other, w->certainty.inflation)) {
            return true;
        }
    }
    return false;
}

/* What the set leaves unexplained, if that is more than the verdict allows, as chi square. */
static double unexplained_of(const session *w, double floor)
{
    evidence_option own;
    const averaged_drive drive = session_drive(w, w->state.z);
    const double floors = in_floors(floor, measure_without_glitches(&w->rows, &drive));
    evidence_cost(&w->view, &w->state, w->state.set, &own);
    return floors > DIAGNOSIS_FLOOR_TOLERANCE ? (floors * floors - 1.0) * own.cost : 0.0;
}

/* Of some members the one that explains least. */
static hypothesis_id least_of(const double cost_without[H_COUNT], hypothesis_set some)
{
    hypothesis_id least = H_COUNT;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(some, h) && (least == H_COUNT || cost_without[h] < cost_without[least])) {
            least = h;
        }
    }
    return least;
}

/* By what the members of the state's set reduce the cost, one by one and together, in chi square. */
typedef struct weighing {
    const session *w;
    double floor, unexplained;
    double own_cost;         /* of the set as it is */
    double without[H_COUNT]; /* reduction by each, given the others */
    standing posterior[H_COUNT];
    hypothesis_set decoys; /* members without a name */
    double of_decoys;      /* reduction by these, given the named ones */
    double with_all;       /* held-out error of the named ones */
} weighing;

static double cost_of(const weighing *g, hypothesis_set set)
{
    evidence_option option;
    evidence_cost(&g->w->view, &g->w->state, set, &option);
    return option.cost;
}

/* Likelier than not, or no set without it is likelier than the state's own. */
static bool is_likely(const standing *of)
{
    return of->alone >= LIKELY || of->rival <= 1.0;
}

static bool weigh(session *w, double floor, double unexplained, weighing *out)
{
    weighing g = {.w = w, .floor = floor, .unexplained = unexplained};
    const hypothesis_set set = w->state.set;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        g.decoys |= hypothesis_in(set, h) && !hypothesis_cause(h)->named ? HYPOTHESIS_BIT(h) : 0;
    }
    g.own_cost = cost_of(&g, set);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        g.without[h] = hypothesis_in(set, h) ? cost_of(&g, set & ~HYPOTHESIS_BIT(h)) - g.own_cost : 0.0;
    }
    g.of_decoys = cost_of(&g, set & ~g.decoys) - g.own_cost;
    g.with_all = session_named_error(w, set);
    *out = g;
    if (!probability_of(&w->view, &w->state, w->allowed, w->certainty.inflation, NULL, NULL,
                        out->posterior)) {
        return false;
    }
    bool likely = true;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        likely = likely && (!hypothesis_in(set, h) || is_likely(&out->posterior[h]));
    }
    /* None goes for a rival that only the parabola makes likelier. */
    return likely || probability_of(&w->view, &w->state, w->allowed, w->certainty.inflation, &w->fitted,
                                    &w->rivals, out->posterior);
}

/* The least reduction by a member, from what the others explain and what nothing does. */
static double bar_of(const weighing *g, hypothesis_id h)
{
    const hypothesis_set set = g->w->state.set;
    if (!hypothesis_cause(h)->named) {
        return 0.0;
    }
    /* What the effects without a name explain, alone or together with this cause: iron loss, say, looks so much like an angle
     * delay that either takes most of what they share. */
    const double shared = g->decoys ? cost_of(g, set & ~g->decoys & ~HYPOTHESIS_BIT(h)) - g->own_cost : 0.0;
    return LEAST_SHARE_OF_REST * (g->unexplained + shared);
}

/* Whether its posterior is high. */
static bool is_probable(const weighing *g, hypothesis_id h)
{
    const hypothesis_set set = g->w->state.set;
    const double pays =
        evidence_penalty(&g->w->view, set) - evidence_penalty(&g->w->view, set & ~HYPOTHESIS_BIT(h));
    return is_likely(&g->posterior[h]) &&
           g->posterior[h].against / g->w->certainty.inflation - pays >= ODDS_OF_NAMED;
}

/*
 * A cause that only absorbs the model error of a dead time, or of an unnamed effect, lowers the error of the fitted rows and raises that
 * of the others. Together with an unnamed effect that explains nearly as much, a cause is named only if it lowers the held-out error and
 * nothing else fits as well.
 */
static bool harms(const weighing *g, hypothesis_id h)
{
    const hypothesis_set set = g->w->state.set;
    if (!hypothesis_cause(h)->named || !(g->decoys || hypotheses_hold(set, CAUSE_DEAD_TIME))) {
        return false;
    }
    const double without = session_named_error(g->w, set & ~HYPOTHESIS_BIT(h));
    const bool in_doubt = g->without[h] < FAR_MORE * g->of_decoys;
    return without < g->with_all ||
           (in_doubt && (without <= 1.005 * g->with_all || is_open(g->w, g->own_cost, h)));
}

static bool is_one_map(const weighing *g, hypothesis_id h)
{
    const hypothesis_set set = g->w->state.set;
    return hypothesis_table[h].cause != CAUSE_SATURATION_DQ ||
           g->w->view.scatter[CAUSE_SATURATION_DQ] <= ONE_MAP ||
           g->with_all < MOST_LEFT * session_named_error(g->w, set & ~HYPOTHESIS_BIT(h));
}

static bool is_worthy(const weighing *g, hypothesis_id h)
{
    return is_probable(g, h) && session_is_large(g->w, h) && is_one_map(g, h) &&
           g->without[h] >= bar_of(g, h) && !harms(g, h);
}

/* The member that is least worth its name, H_COUNT if all are. */
static hypothesis_id weakest(const session *w, const weighing *g)
{
    /* What dead time's law leaves near zero current looks like an effect without a name: if the named ones reach the noise, one
     * of them a dead time, that goes first. */
    if (g->decoys && g->floor > 0.0 && hypotheses_hold(w->state.set, CAUSE_DEAD_TIME) &&
        in_floors(g->floor, g->with_all) <= DIAGNOSIS_FLOOR_TOLERANCE) {
        return least_of(g->without, g->decoys);
    }
    hypothesis_set unworthy = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        unworthy |= hypothesis_in(w->state.set, h) && !is_worthy(g, h) ? HYPOTHESIS_BIT(h) : 0;
    }
    return least_of(g->without, unworthy);
}

/* A delay whose part of a cycle is below the reporting threshold may still be one of whole cycles: that one, H_COUNT if there is none. */
static hypothesis_id whole_of(const fit_state *s, hypothesis_id h)
{
    const hypothesis *part = &hypothesis_table[h];
    const size_t whole = part->size == SIZE_FROM_WHOLE
                             ? part->fixed + (size_t)lround(fmax(s->z[part->column[part->columns - 1]], 0.0))
                             : 0;
    for (hypothesis_id other = 0; whole > 0 && other < H_COUNT; other++) {
        const hypothesis *o = &hypothesis_table[other];
        if (o->cause == part->cause && o->fixed == o->columns && o->fixed == whole) {
            return other;
        }
    }
    return H_COUNT;
}

/* A hypothesis that is not fitted joins a state: it is, or is not. */
static void join_whole(fit_state *s, hypothesis_id h)
{
    s->set |= HYPOTHESIS_BIT(h);
    for (size_t k = 0; k < hypothesis_table[h].fixed; k++) {
        s->z[hypothesis_table[h].column[k]] = 1.0;
    }
}

/* By what share each effect differs from one operating point to the next: what LAW_HOLDS is measured by. */
static void tell_scatter(const session *w)
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const double share = w->view.scatter[hypothesis_table[h].cause];
        if (hypothesis_in(w->state.set, h) && share != 0.0) {
            session_trace(w, "  between operating points %s differs by %.3g %%%s\n", hypothesis_cause(h)->id,
                          100.0 * fmax(share, 0.0), share < 0.0 ? " at the most that noise does" : "");
        }
    }
}

/* Fits the set to be weighed. Roughly is as well as a search ranks by: once so much was tried, to tell who goes. */
static bool refine(session *w, bool roughly)
{
    double alone;
    const fit_aim rough = fit_ranked(INFINITY);
    return roughly ? fit_refine_within(&w->fitted, &w->state, ROUGH_STEPS, &rough, &alone)
                   : fit_refine(&w->fitted, &w->state, PRUNE_STEPS);
}

/* Fits the state's set and drops, one by one, what is not certain, until all that stays is. Raises `least` to what the
 * next search's causes must explain to stay here. */
static bool prune(session *w, double *least)
{
    for (bool roughly = fit_has_spent(&w->fitted);;) {
        if (!refine(w, roughly) || !certainty_of(&w->fitted, &w->state, &w->certainty) || !session_look(w)) {
            return false;
        }
        const double floor = session_floor(w, &w->state);
        const double unexplained = unexplained_of(w, floor);
        weighing g;
        if (!weigh(w, floor, unexplained, &g)) {
            return false;
        }
        const hypothesis_id worst = weakest(w, &g);
        if (worst == H_COUNT && roughly) {
            roughly = false;
            continue;
        }
        if (worst == H_COUNT) {
            tell_scatter(w);
            return true;
        }
        session_trace(w, "  not certain, or too small a part: %s\n", hypothesis_table[worst].words);
        /* A flux map that is not worth its name with some of its terms is not with others. */
        w->allowed &= ~(hypothesis_table[worst].cause == CAUSE_SATURATION_DQ
                            ? hypotheses_of_cause(hypothesis_cause(worst)->id)
                            : HYPOTHESIS_BIT(worst));
        const hypothesis_id whole = whole_of(&w->state, worst);
        search_take_out(&w->fitted, &w->state, worst, w->allowed);
        if (whole != H_COUNT && hypothesis_in(w->allowed, whole) && hypothesis_joins(w->state.set, whole)) {
            join_whole(&w->state, whole);
        }
        /* Half, as another set may leave less. */
        *least = fmax(*least, 0.5 * LEAST_SHARE_OF_REST * unexplained);
    }
}

static void tell_spent(const session *w)
{
    session_trace(w, "  so much was tried that nothing is searched for in place of what was dropped\n");
}

static bool find(session *w, hypothesis_set possible)
{
    w->state = w->nominal;
    w->allowed = possible;
    w->view.stands = false;
    fit_grant(&w->fitted);
    double least = 0.0;
    fitted_sets fitted = {0};
    fit_state pruned = w->state;
    bool ok = true;
    for (bool first = true; ok; first = false) {
        ok = search_best(&w->fitted, &w->state, w->allowed, w->nominal.objective, least, &fitted, &w->view,
                         &w->teller);
        if (ok && !first && w->state.set == pruned.set) {
            break;
        }
        ok = ok && prune(w, &least);
        pruned = w->state;
        if (w->state.set == 0 && w->allowed == possible) {
            break; /* nothing found, nothing dropped */
        }
        if (fit_has_spent(&w->fitted)) {
            tell_spent(w);
            break;
        }
    }
    /* The last search may have turned a stretch or moved the edge's law without changing the set. */
    ok = ok && (evidence_is_same(&pruned, &w->state) || certainty_of(&w->fitted, &w->state, &w->certainty));
    fitted_sets_free(&fitted);
    return ok;
}

bool causes_find(session *w)
{
    return find(w, w->possible);
}

bool causes_bear_out(session *w)
{
    if (hypotheses_named(w->state.set) == 0 || session_borne_out(w, &w->rows) >= LIKELY) {
        return true;
    }
    char words[256];
    session_trace(w, "  more is left than they explain, and none is named: %s\n",
                  evidence_words(w->state.set, words, sizeof words));
    w->more_left = true;
    /* It was the best set there is: no other explains more, and no part of it. */
    return find(w, w->possible & ~hypotheses_named(w->possible));
}

/* By less than this share chance decides, as where an effect hardly shows in one cycle. */
static const double HARM = 0.97;

bool causes_reject_harmful(session *w)
{
    for (;;) {
        const double with_all = session_named_error(w, w->state.set);
        hypothesis_id worst = H_COUNT;
        double least = HARM * with_all;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            const double without = hypothesis_in(w->state.set, h) && hypothesis_cause(h)->named
                                       ? session_named_error(w, w->state.set & ~HYPOTHESIS_BIT(h))
                                       : INFINITY;
            if (without < least) {
                least = without;
                worst = h;
            }
        }
        if (worst == H_COUNT) {
            return true;
        }
        session_trace(w, "  raises the held-out error: %s\n", hypothesis_table[worst].words);
        w->allowed &= ~HYPOTHESIS_BIT(worst);
        search_take_out(&w->fitted, &w->state, worst, w->allowed);
        if (!refine(w, false) || !certainty_of(&w->fitted, &w->state, &w->certainty)) {
            return false;
        }
    }
}

bool causes_split_saturation(session *w)
{
    const hypothesis_set split = HYPOTHESIS_BIT(H_INDUCTANCE) | HYPOTHESIS_BIT(H_FALL);
    const double least = w->frame.of_least * hypothesis_table[H_INDUCTANCE].least;
    if (!hypothesis_in(w->state.set, H_SATURATION) || !hypothesis_in(w->possible, H_INDUCTANCE) ||
        !hypothesis_saturation_is_off(w->state.z, w->frame.of_least) ||
        !certainty_exceeds(&w->certainty, &w->state, H_INDUCTANCE, least)) {
        return true;
    }
    session_trace(w, "  at no current has the inductance the motor file's value: two causes\n");
    w->state.set = (w->state.set & ~HYPOTHESIS_BIT(H_SATURATION)) | split;
    return certainty_of(&w->fitted, &w->state, &w->certainty);
}

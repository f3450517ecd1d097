/* Directions that a recording does not show (visible.h). */
#include "visible.h"

#include "base/solve.h"
#include "known.h"
#include "values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS = 4 };

static const struct {
    const char *name;
    coordinate_id coordinate;
} number[NUMBERS] = {{"R", P_R}, {"L_d", P_L_D}, {"L_q", P_L_Q}, {"psi_f", P_PSI}};

/* A direction is shown if it is known twice as well as is usual anyhow. */
static const double SHOWN = 4.0;
/* What belongs to a direction. */
static const double PART = 0.1;
/* In -2 log of odds: explanations this far behind the best count, and the best must reduce the error by as much. */
static const double ALIKE = 12.0;
/* The least probability of an explanation by another factor on the drive. */
static const double LEAST_SHARE = 0.02;
/* The most causes of one explanation, if several are undecided. */
enum { MEMBERS = 2 };

/* The information about the numbers in addition to the prior of usual sizes; the others are unchanged. */
static void information(const session *w, const evidence_view *view, double a[NUMBERS * NUMBERS])
{
    for (size_t i = 0; i < NUMBERS; i++) {
        for (size_t j = 0; j < NUMBERS; j++) {
            const coordinate_id p = number[i].coordinate;
            const coordinate_id q = number[j].coordinate;
            a[i * NUMBERS + j] =
                coordinate_usual(p) * view->sums.h[p][q] * coordinate_usual(q) / w->certainty.inflation +
                (i == j ? 1.0 : 0.0);
        }
    }
}

static void put_words(diagnosis_direction *out)
{
    size_t used = 0;
    for (size_t k = 0; k < out->count && used < sizeof out->words; k++) {
        const int n = snprintf(out->words + used, sizeof out->words - used, "%s%s",
                               k == 0 ? "" : (k + 1 == out->count ? " and " : ", "), out->name[k]);
        used += n > 0 ? (size_t)n : 0;
    }
    if (used < sizeof out->words) {
        snprintf(out->words + used, sizeof out->words - used, "%s",
                 out->count > 1 ? " cannot be separated in this recording"
                                : " does not show in this recording");
    }
}

static void tell_directions(const session *w, const evidence_view *view, diagnosis *d)
{
    double vector[NUMBERS * NUMBERS];
    double value[NUMBERS];
    information(w, view, vector);
    if (!solve_symmetric(NUMBERS, vector, value)) {
        return;
    }
    for (size_t v = 0; v < NUMBERS && d->directions < DIAGNOSIS_DIRECTIONS; v++) {
        diagnosis_direction *out = &d->not_visible[d->directions];
        double most = 0.0;
        *out = (diagnosis_direction){.count = 0};
        for (size_t i = 0; value[v] < SHOWN && i < NUMBERS; i++) {
            const double part = vector[i * NUMBERS + v];
            if (fabs(part) >= PART) {
                out->name[out->count] = number[i].name;
                out->share[out->count++] = part * coordinate_usual(number[i].coordinate);
                most = fmax(most, fabs(part * coordinate_usual(number[i].coordinate)));
            }
        }
        for (size_t k = 0; k < out->count; k++) {
            out->share[k] /= most;
        }
        if (out->count > 0) {
            put_words(out);
            d->directions++;
        }
    }
}

/* The explanations that were found, the best first. */
typedef struct explanation_list {
    size_t count, most; /* most: the members of one */
    size_t columns;     /* the most of one that is undecided: what moves more than these fits more */
    evidence_option option[DIAGNOSIS_EXPLANATIONS];
} explanation_list;

static void keep_explanation(explanation_list *list, const evidence_option *option)
{
    size_t at = list->count < DIAGNOSIS_EXPLANATIONS ? list->count++ : DIAGNOSIS_EXPLANATIONS;
    for (; at > 0 && option->score < list->option[at - 1].score; at--) {
        if (at < DIAGNOSIS_EXPLANATIONS) {
            list->option[at] = list->option[at - 1];
        }
    }
    if (at < DIAGNOSIS_EXPLANATIONS) {
        list->option[at] = *option;
    }
}

/* Adds the sets with one member more, from `first` on, to a set of this cost, and those with more. */
static void add_explanations(const session *w, const evidence_view *view, hypothesis_set set, double cost,
                             hypothesis_id first, size_t more, explanation_list *list)
{
    const double alike = ALIKE * w->certainty.inflation;
    for (hypothesis_id h = first; more > 0 && h < H_COUNT; h++) {
        evidence_option option;
        evidence_option without;
        const hypothesis_set with = set | HYPOTHESIS_BIT(h);
        if (!hypothesis_in(w->possible, h) || !hypothesis_cause(h)->named || !hypothesis_joins(set, h) ||
            hypothesis_table[h].columns > list->columns) {
            continue;
        }
        const bool is_choice = evidence_cost(view, &w->state, with, &option) || with == w->state.set;
        bool needed = is_choice && cost - option.cost >= alike;
        for (hypothesis_id other = 0; needed && other < first; other++) {
            if (hypothesis_in(set & ~w->state.set, other) || hypothesis_in(set & w->undecided, other)) {
                evidence_cost(view, &w->state, with & ~HYPOTHESIS_BIT(other), &without);
                needed = without.cost - option.cost >= alike;
            }
        }
        if (needed) {
            keep_explanation(list, &option);
        }
        add_explanations(w, view, with, option.cost, h + 1, more - 1, list);
    }
}

static void put_explanation(hypothesis_set set, double probability, diagnosis *d)
{
    diagnosis_explanation *out = &d->explanation[d->explanations++];
    size_t used = 0;
    *out = (diagnosis_explanation){.probability = probability};
    for (hypothesis_id h = 0; h < H_COUNT && out->count < DIAGNOSIS_ALIKE; h++) {
        if (hypothesis_in(set, h) && used < sizeof out->words) {
            const char *id = hypothesis_cause(h)->id;
            const int n = snprintf(out->words + used, sizeof out->words - used, "%s%s",
                                   out->count > 0 ? " + " : "", id);
            used += n > 0 ? (size_t)n : 0;
            out->id[out->count++] = id;
        }
    }
}

/* The member of the fitted set that a cause is. */
static hypothesis_id member_of(const session *w, const diagnosis_cause *cause)
{
    hypothesis_id h = 0;
    while (h < H_COUNT &&
           !(hypothesis_in(w->state.set, h) && strcmp(hypothesis_cause(h)->id, cause->id) == 0)) {
        h++;
    }
    return h;
}

static void widen(const session *w, const session *other, diagnosis_cause *causes, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        diagnosis_cause *cause = &causes[k];
        diagnosis_cause there = *cause;
        const hypothesis_id h = member_of(w, cause);
        if (h < H_COUNT) {
            values_tell(other, h, other->state.z, &there);
        }
        for (size_t n = 0; n < cause->parameters; n++) {
            cause->parameter[n].low = fmin(cause->parameter[n].low, there.parameter[n].low);
            cause->parameter[n].high = fmax(cause->parameter[n].high, there.parameter[n].high);
        }
    }
}

/* Another explanation moves the values of causes and minor effects: their intervals reach as far. */
static void widen_named(const session *w, const evidence_option *option, diagnosis *d)
{
    session *other = malloc(sizeof *other);
    if (!other) {
        rows_note_no_memory(&w->rows);
        return;
    }
    *other = *w;
    memcpy(other->state.z, option->z, sizeof other->state.z);
    widen(w, other, d->cause, d->causes);
    widen(w, other, d->minor, d->minors);
    known_reach(other, d);
    free(other);
}

/* What of hypotheses_scaled is beyond its threshold at such a factor, without what is named. */
static hypothesis_set moved_by_scale(size_t which, hypothesis_set named)
{
    hypothesis_set set = 0;
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        const bool moved = (which >> k & 1U) != 0 && !hypotheses_move_scaled(named, k);
        set |= moved ? HYPOTHESIS_BIT(hypotheses_scaled[k]) : 0;
    }
    return set;
}

/* The drives by another factor, the most probable first. */
static void tell_scales(const session *w, hypothesis_set named, diagnosis *d)
{
    /* At the first of those that move the same in addition: all their shares, and the factor of the largest. */
    drive_scale together[DRIVE_SCALES] = {{0.0, 0.0}};
    double largest[DRIVE_SCALES] = {0.0};
    double told = 0.0;
    for (size_t which = 0; which < DRIVE_SCALES; which++) {
        const drive_scale *scale = &w->scale[which];
        size_t first = 0;
        while (moved_by_scale(first, named) != moved_by_scale(which, named)) {
            first++;
        }
        together[first].share += scale->share;
        if (scale->share > largest[first]) {
            largest[first] = scale->share;
            together[first].factor = scale->factor;
        }
    }
    for (size_t n = 0; n < DIAGNOSIS_EXPLANATIONS; n++) {
        size_t best = 0;
        evidence_option option;
        for (size_t which = 1; which < DRIVE_SCALES; which++) {
            best = together[which].share > together[best].share ? which : best;
        }
        const hypothesis_set moved = moved_by_scale(best, named);
        if (moved != 0 && together[best].share > LEAST_SHARE) {
            memcpy(option.z, w->state.z, sizeof option.z);
            coordinates_scale(&w->frame, together[best].factor, 1.0, option.z);
            put_explanation(moved, together[best].share, d);
            told += together[best].share;
            widen_named(w, &option, d);
        }
        together[best].share = 0.0;
    }
    for (size_t n = 0; n < d->explanations; n++) {
        d->explanation[n].probability /= told;
    }
    d->alike_by_scale = d->explanations > 0;
}

void explanations_tell(const session *w, const evidence_view *view, hypothesis_set named, diagnosis *d)
{
    d->explanations = 0; /* those of a call before */
    bool by_scale = false;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        by_scale =
            by_scale || (hypothesis_in(w->undecided, h) && session_scale_doubt(w, h) > SESSION_SCALE_DOUBTED);
    }
    if (by_scale) {
        tell_scales(w, named & ~w->minor, d);
        return;
    }
    explanation_list list = {.most = 1, .columns = 1};
    evidence_option none;
    double weight[DIAGNOSIS_EXPLANATIONS] = {0.0};
    double sum = 0.0;
    size_t n = 0;
    for (hypothesis_id h = 0, members = 0; h < H_COUNT; h++) {
        if (hypothesis_in(w->undecided, h)) {
            const size_t columns = hypothesis_table[h].columns;
            list.most = ++members > 1 ? MEMBERS : 1;
            list.columns = columns > list.columns ? columns : list.columns;
        }
    }
    evidence_cost(view, &w->state, named, &none);
    add_explanations(w, view, named, none.cost, 0, list.most, &list);
    for (; n < list.count; n++) {
        const double behind = list.option[n].score - list.option[0].score;
        if (behind >= ALIKE * w->certainty.inflation) {
            break;
        }
        weight[n] = exp(-0.5 * behind / w->certainty.inflation);
        sum += weight[n];
    }
    for (size_t k = 0; n > 1 && k < n; k++) {
        put_explanation(list.option[k].set & ~named, weight[k] / sum, d);
        widen_named(w, &list.option[k], d);
    }
}

void visible_tell(const session *w, const evidence_view *view, diagnosis *d)
{
    tell_directions(w, view, d);
    const bool clean = d->verdict == VERDICT_CLEAN && d->directions > 0;
    if (clean) {
        explanations_tell(w, view, hypotheses_named(w->state.set), d);
    }
    if ((clean && (!diagnosis_at_floor(d, d->nominal) || d->explanations > 0)) || w->undecided != 0) {
        d->verdict = d->causes > 0 ? VERDICT_PARTLY : VERDICT_UNEXPLAINED;
    }
}

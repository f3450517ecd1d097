/* Directions that a recording does not show (visible.h). */
#include "visible.h"

#include "base/solve.h"

#include <math.h>
#include <stdio.h>

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

void explanations_tell(const session *w, const evidence_view *view, hypothesis_set named, diagnosis *d)
{
    double score[DIAGNOSIS_EXPLANATIONS] = {0};
    evidence_option none;
    double sum = 0.0;
    evidence_cost(view, &w->state, named, &none);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        evidence_option option;
        if (!hypothesis_in(w->possible, h) || !hypothesis_cause(h)->named || !hypothesis_joins(named, h) ||
            (hypothesis_table[h].columns > 1 && !hypothesis_in(w->undecided, h)) ||
            !evidence_cost(view, &w->state, named | HYPOTHESIS_BIT(h), &option) ||
            none.cost - option.cost < ALIKE * w->certainty.inflation) {
            continue;
        }
        size_t at = d->explanations < DIAGNOSIS_EXPLANATIONS ? d->explanations++ : DIAGNOSIS_EXPLANATIONS;
        for (; at > 0 && option.score < score[at - 1]; at--) {
            if (at < DIAGNOSIS_EXPLANATIONS) {
                score[at] = score[at - 1];
                d->explanation[at] = d->explanation[at - 1];
            }
        }
        if (at < DIAGNOSIS_EXPLANATIONS) {
            score[at] = option.score;
            d->explanation[at].id = hypothesis_cause(h)->id;
        }
    }
    size_t n = 0;
    for (; n < d->explanations && score[n] - score[0] < ALIKE * w->certainty.inflation; n++) {
        d->explanation[n].probability = exp(-0.5 * (score[n] - score[0]) / w->certainty.inflation);
        sum += d->explanation[n].probability;
    }
    d->explanations = n > 1 ? n : 0;
    for (size_t k = 0; k < d->explanations; k++) {
        d->explanation[k].probability /= sum;
    }
}

void visible_tell(const session *w, const evidence_view *view, diagnosis *d)
{
    tell_directions(w, view, d);
    const bool errs = d->nominal > DIAGNOSIS_FLOOR_TOLERANCE * d->noise_floor;
    const bool hidden = d->verdict == VERDICT_CLEAN && errs && d->directions > 0;
    if (hidden || w->undecided != 0) {
        d->verdict = d->causes > 0 ? VERDICT_PARTLY : VERDICT_UNEXPLAINED;
    }
    if (hidden) {
        explanations_tell(w, view, hypotheses_named(w->state.set), d);
    }
}

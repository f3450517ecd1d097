/* What could take a cause's place (confusion.h). */
#include "confusion.h"

#include <string.h>

/* Chi square below which a replacement is as good: one more parameter by chance reaches it once in ten
 * thousand times. */
static const double AS_GOOD = 15.0;

bool confusion_of(const evidence_view *view, const fit_state *s, double own_cost, hypothesis_id member,
                  hypothesis_id other, double inflation)
{
    hypothesis_set rest = s->set & ~HYPOTHESIS_BIT(member);
    evidence_option option;
    return hypothesis_cause(other)->named && hypothesis_joins(rest, other) &&
           strcmp(hypothesis_cause(other)->id, hypothesis_cause(member)->id) != 0 &&
           !hypothesis_contains(other, member) &&
           evidence_cost(view, s, rest | HYPOTHESIS_BIT(other), &option) &&
           option.cost - own_cost <= AS_GOOD * inflation;
}

void confusion_find(diagnosis *d, const evidence_view *view, const fit_state *s, const hypothesis_id *member,
                    hypothesis_set possible, double inflation)
{
    evidence_option own;
    evidence_cost(view, s, s->set, &own);
    for (size_t k = 0; k < d->causes; k++) {
        diagnosis_cause *cause = &d->cause[k];
        cause->confused = 0;
        for (hypothesis_id h = 0; h < H_COUNT && cause->confused < DIAGNOSIS_CONFUSED; h++) {
            if (!(possible & HYPOTHESIS_BIT(h)) ||
                !confusion_of(view, s, own.cost, member[k], h, inflation)) {
                continue;
            }
            bool listed = false;
            for (size_t j = 0; j < cause->confused; j++) {
                listed = listed || strcmp(cause->confused_with[j], hypothesis_cause(h)->id) == 0;
            }
            if (!listed) {
                cause->confused_with[cause->confused++] = hypothesis_cause(h)->id;
            }
        }
    }
}

typedef struct trade {
    const evidence_view *view;
    const fit_state *state;
    hypothesis_set rest, candidates;
    double bound;
} trade;

/* The first set of `more` candidates that, added to the rest, stays within the bound; 0 if there is none. */
static hypothesis_set first_trade(const trade *t, hypothesis_set added, hypothesis_id from, int more)
{
    evidence_option option;
    if (more == 0) {
        const bool fits =
            evidence_cost(t->view, t->state, t->rest | added, &option) && option.cost <= t->bound;
        return fits ? added : 0;
    }
    for (hypothesis_id h = from; h < H_COUNT; h++) {
        if (hypothesis_in(t->candidates, h) && hypothesis_joins(t->rest | added, h)) {
            const hypothesis_set found = first_trade(t, added | HYPOTHESIS_BIT(h), h + 1, more - 1);
            if (found) {
                return found;
            }
        }
    }
    return 0;
}

void confusion_trades(diagnosis *d, const evidence_view *view, const fit_state *s,
                      const hypothesis_id *member, hypothesis_set possible, double inflation)
{
    evidence_option own;
    evidence_cost(view, s, s->set, &own);
    for (size_t k = 0; k < d->causes; k++) {
        const unsigned scales =
            SCALES_RESISTANCE | SCALES_INDUCTANCE | SCALES_FLUX | SCALES_VOLTAGE | SCALES_CURRENT;
        trade t = {.view = view,
                   .state = s,
                   .rest = s->set & ~HYPOTHESIS_BIT(member[k]),
                   .bound = own.cost + AS_GOOD * inflation};
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            const hypothesis *hypo = &hypothesis_table[h];
            if (hypothesis_in(possible, h) && hypothesis_cause(h)->named && (hypo->role & scales) != 0 &&
                hypo->columns == 1 && hypo->cause != hypothesis_table[member[k]].cause) {
                t.candidates |= HYPOTHESIS_BIT(h);
            }
        }
        hypothesis_set found = 0;
        for (int size = 2;
             (hypothesis_table[member[k]].role & scales) != 0 && size <= DIAGNOSIS_TRADES && !found; size++) {
            found = first_trade(&t, 0, 0, size);
        }
        d->cause[k].trades = 0;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            if (hypothesis_in(found, h)) {
                d->cause[k].trade[d->cause[k].trades++] = hypothesis_cause(h)->id;
            }
        }
    }
}

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

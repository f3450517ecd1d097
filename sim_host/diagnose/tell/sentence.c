/* The verdict's sentence (sentence.h). */
#include "sentence.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The parameter that is farthest from the file for its interval: the one that speaks. */
static const diagnosis_parameter *telling(const diagnosis_cause *cause)
{
    const diagnosis_parameter *best = &cause->parameter[0];
    double most = -1.0;
    for (size_t k = 0; k < cause->parameters; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        const double width = p->high - p->low;
        const double away = width > 0.0 ? fabs(p->value - p->nominal) / width : 0.0;
        if (away > most) {
            most = away;
            best = p;
        }
    }
    return best;
}

/* The value that stands for a cause in a sentence: "v_dead = 3.39 V (3.35 to 3.43)". */
static int value_text(char *out, size_t size, const diagnosis_parameter *p)
{
    const char *unit = strcmp(p->unit, "1") == 0 ? "" : p->unit;
    return snprintf(out, size, "%s = %.4g%s%s", p->name, p->value, unit[0] ? " " : "", unit);
}

void sentence_tell(diagnosis *d)
{
    char *out = d->sentence;
    size_t size = sizeof d->sentence;
    if (d->causes == 0) {
        snprintf(out, size,
                 d->verdict == VERDICT_CLEAN ? "The model with the motor file's values already predicts this "
                                               "recording to its noise: error %.3g %%, floor %.3g %%."
                                             : "The model errs by %.3g %% where noise would leave %.3g %%, "
                                               "and no known effect accounts for it.",
                 d->nominal, d->noise_floor);
        return;
    }
    size_t used = 0;
    for (size_t k = 0; k < d->causes && used < size; k++) {
        char value[64];
        value_text(value, sizeof value, telling(&d->cause[k]));
        int n = snprintf(out + used, size - used, "%s%s (%s)",
                         k == 0 ? "" : (k + 1 == d->causes ? " and " : ", "), d->cause[k].id, value);
        used += n > 0 ? (size_t)n : 0;
    }
    if (used < size) {
        snprintf(out + used, size - used,
                 "%s: the error falls from %.3g %% to %.3g %% (noise floor %.3g %%).",
                 d->verdict == VERDICT_EXPLAINED
                     ? (d->causes > 1 ? " explain what the model gets wrong"
                                      : " explains what the model gets wrong")
                     : (d->causes > 1 ? " explain a part of what the model gets wrong"
                                      : " explains a part of what the model gets wrong"),
                 d->nominal, d->extended, d->noise_floor);
    }
}

/* The verdict's sentence (sentence.h). */
#include "sentence.h"

#include "base/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The parameter that is farthest from the motor file, in widths of its interval; a phase alone says nothing. */
static const diagnosis_parameter *telling(const diagnosis_cause *cause)
{
    const diagnosis_parameter *best = &cause->parameter[0];
    double most = -1.0;
    for (size_t k = 0; k < cause->parameters; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        const double width = p->high - p->low;
        const double away = width > 0.0 ? fabs(p->value - p->nominal) / width : 0.0;
        if (away > most && strcmp(p->name, "phase") != 0) {
            most = away;
            best = p;
        }
    }
    return best;
}

/* The value that describes a cause in a sentence: "v_dead = 3.39 V". */
static int value_text(char *out, size_t size, const diagnosis_parameter *p)
{
    const char *unit = strcmp(p->unit, "1") == 0 ? "" : p->unit;
    return snprintf(out, size, "%s = %.4g%s%s", p->name, p->value, unit[0] ? " " : "", unit);
}

void sentence_tell(diagnosis *d)
{
    char *out = d->sentence;
    size_t size = sizeof d->sentence;
    char nominal[NUMBER_TEXT_SIZE];
    char extended[NUMBER_TEXT_SIZE];
    char floor[NUMBER_TEXT_SIZE];
    (void)number_percent(d->nominal, nominal);
    (void)number_percent(d->noise_floor, floor);
    if (d->causes == 0 && d->explanations > 0) {
        size_t used = (size_t)snprintf(
            out, size, "The error of the nominal model is %s, the noise floor %s. ", nominal, floor);
        for (size_t k = 0; k < d->explanations && used < size; k++) {
            const int n =
                snprintf(out + used, size - used, "%s%s", k > 0 ? " or " : "", d->explanation[k].words);
            used += n > 0 ? (size_t)n : 0;
        }
        if (used < size) {
            snprintf(out + used, size - used,
                     " explains the difference: this recording does not show which.");
        }
        return;
    }
    if (d->causes == 0) {
        const bool off = !diagnosis_at_floor(d, d->nominal);
        if (d->verdict == VERDICT_CLEAN) {
            snprintf(out, size,
                     "The nominal model predicts this recording to the noise%s: error %s, noise floor %s.",
                     off ? " and the tolerance of the motor file" : "", nominal, floor);
            return;
        }
        snprintf(out, size, "The error of the nominal model is %s, the noise floor %s. %s", nominal, floor,
                 off && diagnosis_at_floor(d, d->within_digits)
                     ? "Values of the motor file that are off by their tolerance may explain the difference."
                 : d->minors > 0 ? "No effect is certain enough to be named."
                                 : "No known effect explains the difference.");
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
        snprintf(out + used, size - used, "%s the model error: %s before, %s after, noise floor %s.",
                 d->verdict == VERDICT_EXPLAINED
                     ? (d->causes > 1 ? " explain" : " explains")
                     : (d->causes > 1 ? " explain a part of" : " explains a part of"),
                 nominal, number_percent(d->extended, extended), floor);
    }
}

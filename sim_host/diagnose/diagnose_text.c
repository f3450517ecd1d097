#include "diagnose_text.h"

#include <string.h>

/* The value that stands for a cause in a sentence: "v_dead = 3.39 V (3.35 to 3.43)". */
static int value_text(char *out, size_t size, const diagnosis_parameter *p)
{
    const char *unit = strcmp(p->unit, "1") == 0 ? "" : p->unit;
    return snprintf(out, size, "%s = %.4g%s%s", p->name, p->value, unit[0] ? " " : "", unit);
}

void diagnose_sentence(diagnosis *d)
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
        value_text(value, sizeof value, &d->cause[k].parameter[0]);
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

void diagnose_print(FILE *out, const diagnosis *d, const char *recording_path, const char *motor_path)
{
    fprintf(out, "%s with %s\n  %s: %s\n", recording_path, motor_path, diagnosis_verdict_id(d->verdict),
            d->sentence);
    for (size_t k = 0; k < d->causes; k++) {
        const diagnosis_cause *cause = &d->cause[k];
        fprintf(out, "\n  %-16s %s; gain %.2f\n", cause->id, cause->words, cause->gain);
        for (size_t j = 0; j < cause->parameters; j++) {
            const diagnosis_parameter *p = &cause->parameter[j];
            fprintf(out, "    %-10s %12.6g %-4s  95 %% %.6g to %.6g   (file: %.6g)\n", p->name, p->value,
                    strcmp(p->unit, "1") == 0 ? "" : p->unit, p->low, p->high, p->nominal);
        }
        for (size_t j = 0; j < cause->confused; j++) {
            fprintf(out, "    this recording cannot tell it from %s\n", cause->confused_with[j]);
        }
    }
    if (d->structure.words[0]) {
        fprintf(out, "\n  left over: %s\n", d->structure.words);
    }
    fprintf(out, "\n  one-cycle error, %% of the current, %zu held-out of %zu rows:\n", d->rows_held_out,
            d->rows_used);
    fprintf(out, "    nominal %.3f   extended %.3f   noise floor %.3f   gain %.2f\n", d->nominal, d->extended,
            d->noise_floor, d->gain);
    fprintf(out, "    by method (extended parameters): Euler %.3f   quasi-discrete %.3f   exact %.3f\n",
            d->method_extended.euler, d->method_extended.quasi_discrete, d->method_extended.exact);
    fprintf(out, "\n  run    rad/s  A rms   nominal  extended  floor   free run: nominal  extended\n");
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *r = &d->run[k];
        fprintf(out, "  %3ld %8.1f %6.2f  %8.3f  %8.3f %6.3f  %17.2f  %8.2f\n", r->run, r->omega_rad_s,
                r->i_rms_A, r->nominal, r->extended, r->noise_floor, r->free_nominal, r->free_extended);
    }
    fprintf(out, "\n  next: %s\n", d->next_experiment);
}

/* The diagnosis on the terminal (text.h). */
#include "text.h"

#include <math.h>
#include <string.h>

/* A run none of whose rows was held out has no such error. */
static void put_cell(FILE *out, int width, int digits, double x)
{
    if (isfinite(x)) {
        fprintf(out, "%*.*f", width, digits, x);
    } else {
        fprintf(out, "%*s", width, "-");
    }
}

void text_print(FILE *out, const diagnosis *d)
{
    fprintf(out, "%s with %s\n  %s: %s\n", d->recording_path, d->motor_path, diagnosis_verdict_id(d->verdict),
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
        for (size_t j = 0; j < cause->trades; j++) {
            fprintf(out, "%s%s%s", j == 0 ? "    the same would be done by " : " + ", cause->trade[j],
                    j + 1 == cause->trades ? " together\n" : "");
        }
    }
    fprintf(out, "\n  known of the machine:");
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        const diagnosis_estimate *e = &d->estimate[k];
        const char *unit = strcmp(e->unit, "1") == 0 ? "" : e->unit;
        fprintf(out, "%s%s ", k == 0 ? " " : ", ", e->name);
        if (e->excited) {
            fprintf(out, "%.4g +- %.2g%s%s", e->value, 0.5 * (e->high - e->low), unit[0] ? " " : "", unit);
        } else {
            fprintf(out, "not excited");
        }
    }
    fputc('\n', out);
    if (d->rows_clipped > 0) {
        fprintf(out,
                "\n  in %zu rows a current sensor stands at the end of its range: they and those about them "
                "are not used\n",
                d->rows_clipped);
    }
    if (d->structure.words[0]) {
        fprintf(out, "\n  left over: %s\n", d->structure.words);
    }
    if (d->learned.terms > 0) {
        fprintf(out, "\n  %s\n", d->learned.words);
        for (size_t k = 0; k < d->learned.terms; k++) {
            const diagnosis_learned_term *t = &d->learned.term[k];
            fprintf(out, "    %-28s %12.5g %s\n", t->name, t->value,
                    strcmp(t->unit, "1") == 0 ? "" : t->unit);
        }
        fprintf(out, "    learned, not named: held-out error %.3f without, %.3f with, gain %.2f\n",
                d->learned.nominal, d->learned.extended, d->learned.gain);
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
        fprintf(out, "  %3ld %8.1f %6.2f", r->run, r->omega_rad_s, r->i_rms_A);
        put_cell(out, 10, 3, r->nominal);
        put_cell(out, 10, 3, r->extended);
        put_cell(out, 7, 3, r->noise_floor);
        put_cell(out, 19, 2, r->free_nominal);
        put_cell(out, 10, 2, r->free_extended);
        fputc('\n', out);
    }
    fprintf(out, "\n  next: %s\n", d->next_experiment);
}

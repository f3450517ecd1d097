/* The diagnosis on the terminal (text.h). */
#include "text.h"

#include "dead_time.h"

#include <math.h>
#include <string.h>

/* A dash if there is no error: a run without held-out rows, a simulation that diverged. */
static void put_cell(FILE *out, int width, int digits, double x)
{
    if (isfinite(x)) {
        fprintf(out, "%*.*f", width, digits, x);
    } else {
        fprintf(out, "%*s", width, "-");
    }
}

/* What is fitted and not named, and what is open between several causes: a line each. */
static void print_minor(FILE *out, const diagnosis *d)
{
    for (size_t k = 0; k < d->minors; k++) {
        const diagnosis_cause *minor = &d->minor[k];
        fprintf(out, "%s%s", k == 0 ? "\n  small or not certain, in the extended motor file: " : "; ",
                minor->id);
        for (size_t j = 0; j < minor->parameters; j++) {
            const diagnosis_parameter *p = &minor->parameter[j];
            fprintf(out, "%s%s = %.4g%s%s", j == 0 ? " " : ", ", p->name, p->value,
                    strcmp(p->unit, "1") == 0 ? "" : " ", strcmp(p->unit, "1") == 0 ? "" : p->unit);
        }
    }
    fputs(d->minors > 0 ? "\n" : "", out);
    for (size_t k = 0; k < d->explanations; k++) {
        fprintf(out, "%s%s (%.2f)",
                k == 0 ? "\n  one of these, and this recording does not tell which: " : ", ",
                d->explanation[k].words, d->explanation[k].probability);
    }
    fputs(d->explanations > 0 ? "\n" : "", out);
}

void text_print(FILE *out, const diagnosis *d)
{
    fprintf(out, "%s with %s\n  %s: %s\n", d->recording_path, d->motor_path, diagnosis_verdict_id(d->verdict),
            d->sentence);
    for (size_t k = 0; k < d->causes; k++) {
        const diagnosis_cause *cause = &d->cause[k];
        fprintf(out, "\n  %-16s %s; error reduction %.2f\n", cause->id, cause->words, cause->gain);
        for (size_t j = 0; j < cause->parameters; j++) {
            const diagnosis_parameter *p = &cause->parameter[j];
            fprintf(out, "    %-10s %12.6g %-4s  95 %% %.6g to %.6g   (file: %.6g)\n", p->name, p->value,
                    strcmp(p->unit, "1") == 0 ? "" : p->unit, p->low, p->high, p->nominal);
        }
        const diagnosis_parameter *dead = dead_time_of(cause);
        if (dead != NULL) {
            char time[64];
            dead_time_words(&d->extended_motor, dead->value, time, sizeof time);
            fprintf(out, "    v_dead as a time: %s\n", time);
        }
        for (size_t j = 0; j < cause->confused; j++) {
            fprintf(out, "    not distinguishable from %s in this recording\n", cause->confused_with[j]);
        }
        for (size_t j = 0; j < cause->trades; j++) {
            fprintf(out, "%s%s%s", j == 0 ? "    equivalent to " : " + ", cause->trade[j],
                    j + 1 == cause->trades ? " together\n" : "");
        }
    }
    print_minor(out, d);
    fprintf(out, "\n  estimates%s:", d->reliable ? "" : " (model incomplete: wider intervals)");
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
    for (size_t k = 0; k < d->directions; k++) {
        fprintf(out, "  not visible: %s\n", d->not_visible[k].words);
    }
    if (d->rows_clipped > 0) {
        fprintf(out,
                "\n  %zu rows with a current sensor at the end of its range: these rows and their neighbours "
                "are not used\n",
                d->rows_clipped);
    }
    if (d->structure.words[0]) {
        fprintf(out, "\n  residual structure: %s\n", d->structure.words);
    }
    if (d->learned.terms > 0) {
        fprintf(out, "\n  %s\n", d->learned.words);
        for (size_t k = 0; k < d->learned.terms; k++) {
            const diagnosis_learned_term *t = &d->learned.term[k];
            fprintf(out, "    %-28s %12.5g %s\n", t->name, t->value,
                    strcmp(t->unit, "1") == 0 ? "" : t->unit);
        }
        fprintf(out,
                "    fitted terms, no named cause: held-out error %.3f without, %.3f with, error reduction "
                "%.2f\n",
                d->learned.nominal, d->learned.extended, d->learned.gain);
    }
    fprintf(out, "\n  one-cycle error, %% of the current, %zu held-out of %zu rows:\n", d->rows_held_out,
            d->rows_used);
    fprintf(out, "    nominal %.3f   extended %.3f   noise floor %.3f   error reduction %.2f\n", d->nominal,
            d->extended, d->noise_floor, d->gain);
    fprintf(out, "    by method (extended parameters): Euler %.3f   quasi-discrete %.3f   exact %.3f\n",
            d->method_extended.euler, d->method_extended.quasi_discrete, d->method_extended.exact);
    fprintf(out, "\n  run    rad/s  A rms   nominal  extended  noise floor   open loop: nominal  extended\n");
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *r = &d->run[k];
        fprintf(out, "  %3ld %8.1f %6.2f", r->run, r->omega_rad_s, r->i_rms_A);
        put_cell(out, 10, 3, r->nominal);
        put_cell(out, 10, 3, r->extended);
        put_cell(out, 13, 3, r->noise_floor);
        put_cell(out, 21, 2, r->free_nominal);
        put_cell(out, 10, 2, r->free_extended);
        fputc('\n', out);
    }
    fprintf(out, "\n  next: %s\n", d->next_experiment);
}

/* The computed next recording in words (experiment_words.h). */
#include "experiment_words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct line {
    char *text;
    size_t size, used;
} line;

static void put(line *l, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    const int n = vsnprintf(l->text + l->used, l->size - l->used, format, list);
    va_end(list);
    if (n > 0) {
        l->used = l->used + (size_t)n < l->size ? l->used + (size_t)n : l->size - 1;
    }
}

/* "i_q 2 A", "i_q -8 to 8 A"; nothing for no current. */
static void put_course(line *l, const char *name, const double ends[2])
{
    if (ends[0] != ends[1]) {
        put(l, ", %s %.3g to %.3g A", name, ends[0], ends[1]);
    } else if (ends[0] != 0.0) {
        put(l, ", %s %.3g A", name, ends[0]);
    }
}

void experiment_piece_words(const plan_piece *p, char *text, size_t size)
{
    line l = {text, size, 0};
    const double begin = round(p->rpm[0]);
    const double end = round(p->rpm[1]);
    put(&l, "%s", p->words);
    if (begin != end) {
        put(&l, ", %.0f to %.0f rpm", begin, end);
    } else if (begin != 0.0) {
        put(&l, ", %.0f rpm", begin);
    }
    put_course(&l, "i_d", p->i_d_A);
    put_course(&l, "i_q", p->i_q_A);
    if (p->square_d_A > 0.0 && p->square_q_A > 0.0) {
        put(&l, ", steps of +-%.3g A on both", p->square_d_A);
    } else if (p->square_d_A > 0.0) {
        put(&l, ", steps of +-%.3g A on i_d", p->square_d_A);
    } else if (p->square_q_A > 0.0) {
        put(&l, ", steps of +-%.3g A on i_q", p->square_q_A);
    }
}

void experiment_width_words(const diagnosis_open *number, double half_width, char *text, size_t size)
{
    line l = {text, size, 0};
    if (fabs(number->value) > half_width) {
        put(&l, "+-%.2g %%", 100.0 * half_width / fabs(number->value));
    } else {
        put(&l, "+-%.2g%s%s", half_width, strcmp(number->unit, "1") == 0 ? "" : " ",
            strcmp(number->unit, "1") == 0 ? "" : number->unit);
    }
}

static void put_number(line *l, const diagnosis_open *number, double half_width)
{
    char text[48];
    experiment_width_words(number, half_width, text, sizeof text);
    put(l, "%s", text);
}

static void put_pair(line *l, const diagnosis_experiment *x)
{
    const diagnosis_candidate *best = &x->candidate[0];
    put(l, " Predicted by the model: the correlation of %s and %s changes from %.2f to %.2f",
        x->number[0].name, x->number[1].name, x->correlation, best->correlation);
    for (size_t n = 0; n < 2; n++) {
        put(l, "%s the 95 %% uncertainty of %s from ", n == 0 ? "," : " and", x->number[n].name);
        put_number(l, &x->number[n], x->number[n].half_width);
        put(l, " to ");
        put_number(l, &x->number[n], best->half_width[n]);
    }
    put(l, ".");
}

static void put_estimates(line *l, const diagnosis_experiment *x)
{
    put(l, " Predicted 95 %% uncertainty:");
    for (size_t n = 0; n < x->numbers; n++) {
        put(l, "%s %s ", n > 0 ? "," : "", x->number[n].name);
        put_number(l, &x->number[n], x->candidate[0].half_width[n]);
    }
    put(l, ".");
}

bool experiment_words(const diagnosis_experiment *x, char *text, size_t size)
{
    line l = {text, size, 0};
    char piece[192];
    if (x->numbers == 0 || !x->candidate[0].enough) {
        return false;
    }
    experiment_piece_words(&x->candidate[0].piece, piece, sizeof piece);
    if (x->tell[0] != NULL) {
        put(&l, "To separate %s from %s, record", x->tell[0], x->tell[1]);
    } else {
        for (size_t n = 0; n < x->numbers; n++) {
            put(&l, "%s%s", n > 0 ? " and " : "", x->number[n].name);
        }
        put(&l, " %s not excited by this recording. Record", x->numbers > 1 ? "are" : "is");
    }
    put(&l, " an additional run of %.3g s: %s.", x->seconds, piece);
    if (x->tell[0] != NULL) {
        put_pair(&l, x);
    } else {
        put_estimates(&l, x);
    }
    return true;
}

/* Lines in the spectrum of what is left (lines.h). */
#include "lines.h"

#include "base/fourier.h"
#include "diagnose/identify/observer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { LONGEST = 4096, SHORTEST = 128, LABELS = 64, ORDER_MOST = 24 };

static const double CHANCE = 1e-6; /* of calling any bin of any run a line by chance */
/* Share of the one-cycle error's power: less does not hurt and is not called structure. */
static const double WORTH_SAYING = 0.03;
/* An error that is hardly above the floor may hold more: where the current hardly moves, quantisation errors
 * are slow lines themselves. */
static const double WORTH_SAYING_NEAR_FLOOR = 0.12;
static const double NEAR_FLOOR = 1.1;

typedef struct line_label {
    bool is_order;
    double number; /* order, or Hz */
    double power;  /* share of its run's power, summed over runs in proportion to their rows */
    size_t runs;
    size_t last; /* the stretch counted last, + 1 */
} line_label;

typedef struct line_list {
    size_t n;
    line_label label[LABELS];
} line_list;

static void add_line(line_list *list, size_t index, bool is_order, double number, double tolerance,
                     double power)
{
    for (size_t k = 0; k < list->n; k++) {
        line_label *l = &list->label[k];
        if (l->is_order == is_order && fabs(l->number - number) <= tolerance) {
            l->power += power;
            l->runs += l->last != index + 1;
            l->last = index + 1;
            return;
        }
    }
    if (list->n < LABELS) {
        list->label[list->n++] = (line_label){is_order, number, power, 1, index + 1};
    }
}

/* The lines of one stretch. */
static void lines_of(fit_data *d, fourier *transform, const fit_state *s, const averaged_drive *drive,
                     const averaged_node *nodes, size_t index, size_t group, double rows_in_all,
                     line_list *list)
{
    diagnose_rows *r = d->rows;
    const stretch *st = &r->recording->stretch[index];
    size_t n = SHORTEST;
    while (2 * n <= st->count - ROWS_HISTORY - OBSERVER_START && 2 * n <= LONGEST) {
        n *= 2;
    }
    row_block block = {.first = st->first + ROWS_HISTORY, .count = n + OBSERVER_START, .group = group};
    double *e = calloc(OBSERVER_OUTPUTS * block.count, sizeof *e);
    fourier_number *rotor = calloc(2 * n, sizeof *rotor);
    if (!e || !rotor) {
        rows_note_no_memory(r);
    } else {
        fourier_number *x = rotor + n;
        const group_noise *noise = &s->noise[group];
        double total = 0.0;
        double omega = 0.0;
        observer_block(r, drive, nodes, &block, noise->gain, 0.0, e, NULL);
        for (size_t j = 0; j < n; j++) {
            const double *v = e + OBSERVER_OUTPUTS * (j + OBSERVER_START);
            const cycle_row *row = &r->row[block.first + OBSERVER_START + j];
            rotor[j].re = v[0] * row->cos_theta + v[1] * row->sin_theta;
            rotor[j].im = v[1] * row->cos_theta - v[0] * row->sin_theta;
            total += v[0] * v[0] + v[1] * v[1];
            omega += row->omega_rad_s / (double)n;
        }
        fourier_forward(transform, n, rotor, x);
        double bin_rad_s = VEC_TWO_PI / ((double)n * r->T_s);
        for (size_t k = 0; k < n && total > 0.0; k++) {
            double power = (x[k].re * x[k].re + x[k].im * x[k].im) / total; /* 1 on average */
            if (power < log(rows_in_all / CHANCE)) {
                continue;
            }
            double frequency = (k <= n / 2 ? (double)k : (double)k - (double)n) * bin_rad_s;
            double order = fabs(omega) > 2.0 * bin_rad_s ? frequency / omega : 1e9;
            /* As a share of the one-cycle error: the filter has summed a slow disturbance up over 1/gain
             * cycles, and a one-cycle error has not. Seen from the stationary frame, where the filter works,
             * the line lies at frequency + omega. */
            double turn = (frequency + omega) * r->T_s;
            double keep = 1.0 - noise->gain;
            double undo = (1.0 + keep * keep - 2.0 * keep * cos(turn)) / (2.0 - noise->gain);
            double share = undo * (power - 1.0) / (double)n * (double)st->count / rows_in_all;
            if (fabs(order) <= ORDER_MOST && fabs(order - round(order)) * fabs(omega) < 1.5 * bin_rad_s) {
                add_line(list, index, true, round(order), 0.5, share);
            } else {
                add_line(list, index, false, frequency / VEC_TWO_PI, 2.0 * bin_rad_s, share);
            }
        }
    }
    free(rotor);
    free(e);
}

bool measure_lines(fit_data *d, const fit_state *s, double excess, diagnosis_structure *found)
{
    diagnose_rows *r = d->rows;
    const recording *rec = r->recording;
    *found = (diagnosis_structure){0};
    averaged_drive drive = fit_drive(d, s);
    averaged_node *nodes = rows_nodes(r, &drive);
    fourier *transform = fourier_new();
    if (!nodes || !transform) {
        free(nodes);
        fourier_free(transform);
        return false;
    }
    line_list list = {0};
    double rows_in_all = 0.0;
    for (size_t k = 0; k < rec->stretches; k++) {
        rows_in_all += (double)rec->stretch[k].count;
    }
    size_t b = 0;
    size_t seen = 0;
    for (size_t k = 0; k < rec->stretches && seen < 200; k++) {
        while (b < r->blocks && r->block[b].stretch < k) {
            b++;
        }
        if (b < r->blocks && r->block[b].stretch == k &&
            rec->stretch[k].count > SHORTEST + ROWS_HISTORY + OBSERVER_START) {
            lines_of(d, transform, s, &drive, nodes, k, r->block[b].group, rows_in_all, &list);
            seen++;
        }
    }
    free(nodes);
    fourier_free(transform);
    const line_label *strongest = NULL;
    for (size_t k = 0; k < list.n; k++) {
        found->share += list.label[k].power;
        if (!strongest || list.label[k].power > strongest->power) {
            strongest = &list.label[k];
        }
    }
    size_t glitches = 0;
    for (size_t k = 0; k < r->rows; k++) {
        glitches += r->outlier[k];
    }
    int used = 0;
    size_t room = sizeof found->words;
    if (glitches >= 3) {
        found->certain = true;
        used +=
            snprintf(found->words + used, room - (size_t)used, "%zu rows stand out as glitches", glitches);
    }
    if (strongest && found->share >= (excess > NEAR_FLOOR ? WORTH_SAYING : WORTH_SAYING_NEAR_FLOOR)) {
        found->certain = true;
        used += snprintf(
            found->words + used, room - (size_t)used,
            strongest->is_order ? "%s%.0f%% of what is left lies in lines, the strongest at order %+.0f of "
                                  "the electrical frequency seen from the rotor (%zu of %zu runs)"
                                : "%s%.0f%% of what is left lies in lines, the strongest at %.0f Hz seen "
                                  "from the rotor (%zu of %zu runs)",
            used ? "; " : "", 100.0 * fmin(found->share, 1.0), strongest->number, strongest->runs, seen);
    }
    if (excess > 1.25) {
        found->certain = true;
        snprintf(found->words + used, room - (size_t)used, "%sthe error is %.2f times the noise floor",
                 used ? "; " : "", excess);
    }
    return true;
}

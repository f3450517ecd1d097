/* Orders of the angle in the innovations (discrepancy.h). */
#include "discrepancy.h"

#include "base/solve.h"
#include "diagnose/identify/gram.h"

#include <math.h>
#include <stdlib.h>

enum { FEW = 3, MOST = 12, ORDERS = 2 * MOST + 1, NUMBERS = 2 * ORDERS };

/* Added to the diagonal, as a share of the rows: orders that too few turns cannot separate. */
static const double RIDGE = 1e-3;
/* Standard deviations of chi square that noise may reach. */
static const double BY_NOISE = 2.0;

typedef struct number {
    double re, im;
} number;

/* Of one operating point: sums of e^(j k theta), k = 0 ... 24, and of the innovations seen from each order. */
typedef struct point_sums {
    double rows;
    number turn[ORDERS];
    number with[ORDERS];
} point_sums;

static void add_row(point_sums *p, const cycle_row *row, const double *e)
{
    number at = {1.0, 0.0};
    p->rows += 1.0;
    for (int k = 0; k < ORDERS; k++) {
        p->turn[k].re += at.re;
        p->turn[k].im += at.im;
        if (k <= MOST) {
            p->with[MOST + k].re += e[0] * at.re + e[1] * at.im;
            p->with[MOST + k].im += e[1] * at.re - e[0] * at.im;
        }
        if (k > 0 && k <= MOST) {
            p->with[MOST - k].re += e[0] * at.re - e[1] * at.im;
            p->with[MOST - k].im += e[1] * at.re + e[0] * at.im;
        }
        at = (number){at.re * row->cos_theta - at.im * row->sin_theta,
                      at.re * row->sin_theta + at.im * row->cos_theta};
    }
}

/* By what the orders from -most to most reduce the square at a point, less what noise does; *variance: of the latter. */
static double worth(const point_sums *p, int most, double *variance)
{
    const int orders = 2 * most + 1;
    const size_t numbers = 2 * (size_t)orders;
    const number *with = p->with + MOST - most;
    double h[NUMBERS * NUMBERS];
    double right[NUMBERS];
    double x[NUMBERS];
    double inverse[NUMBERS * NUMBERS];
    double sum = 0.0;
    double free_numbers = 0.0;
    for (int i = 0; i < orders; i++) {
        right[2 * i] = with[i].re;
        right[2 * i + 1] = with[i].im;
        for (int k = 0; k < orders; k++) {
            const number t = p->turn[abs(k - i)];
            const double im = k >= i ? t.im : -t.im;
            double *at = h + (size_t)(2 * i) * numbers + 2 * k;
            at[0] = at[numbers + 1] = t.re + (k == i ? RIDGE * p->rows : 0.0);
            at[1] = -im;
            at[numbers] = im;
        }
    }
    if (!solve_positive(numbers, numbers, h, right, x) || !solve_inverse(numbers, numbers, h, inverse)) {
        return 0.0;
    }
    for (size_t k = 0; k < numbers; k++) {
        sum += x[k] * right[k];
        free_numbers += 1.0 - RIDGE * p->rows * inverse[k * numbers + k];
    }
    *variance += 2.0 * free_numbers;
    return sum - free_numbers;
}

/* By what the orders from -most to most reduce the square of all points, as far as noise does not. */
static double certain_worth(const point_sums *point, size_t points, int most)
{
    double sum = 0.0;
    double variance = 0.0;
    for (size_t g = 0; g < points; g++) {
        sum += point[g].rows > 0.0 ? worth(&point[g], most, &variance) : 0.0;
    }
    return fmax(sum - BY_NOISE * sqrt(variance), 0.0);
}

/* Whitened innovations of a drive over a block, and their square. */
static double innovations(diagnose_rows *r, const averaged_drive *drive, const averaged_node *nodes,
                          const row_block *block, const group_noise *noise, double *e)
{
    double square = 0.0;
    observer_block(r, drive, nodes, block, noise->gain, 0.0, e, NULL);
    gram_whiten(noise, block->count, e, e);
    for (size_t j = 0; j < block->count; j++) {
        const double *v = e + OBSERVER_OUTPUTS * j;
        square += v[0] * v[0] + v[1] * v[1];
    }
    return square;
}

double discrepancy_share(fit_data *d, const fit_state *s, const averaged_drive *drive,
                         const diagnose_rows *from)
{
    diagnose_rows *r = d->rows;
    diagnose_rows recorded = *from;
    averaged_node *nodes = rows_nodes(r, drive);
    averaged_node *nominal_nodes = rows_nodes(r, &d->frame->nominal);
    double *e = calloc(OBSERVER_OUTPUTS * d->longest, sizeof *e);
    point_sums *point = calloc(r->groups, sizeof *point);
    double explained = 0.0;
    double left = 0.0;
    if (nodes && nominal_nodes && e && point) {
        for (size_t b = 0; b < d->blocks; b++) {
            const row_block *block = &r->block[d->block[b]];
            const group_noise *noise = &s->noise[block->group];
            explained += innovations(&recorded, &d->frame->nominal, nominal_nodes, block, noise, e);
            explained -= innovations(r, drive, nodes, block, noise, e);
            for (size_t j = 0; j < block->count; j++) {
                add_row(&point[block->group], &r->row[block->first + j], e + OBSERVER_OUTPUTS * j);
            }
        }
        left = fmax(certain_worth(point, r->groups, FEW), certain_worth(point, r->groups, MOST));
    } else {
        rows_note_no_memory(r);
    }
    free(nodes);
    free(nominal_nodes);
    free(e);
    free(point);
    return explained > 0.0 ? left / explained : 0.0;
}

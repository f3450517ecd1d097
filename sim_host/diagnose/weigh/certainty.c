/* Covariances that stay honest, and intervals from them (certainty.h). */
#include "certainty.h"

#include "base/normal.h"
#include "base/solve.h"
#include "diagnose/identify/gram.h"
#include "diagnose/identify/last_digits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The half width of what cannot be known, in z. */
static const double UNKNOWN = 1e6;

/* Student's t, 97.5 %. */
static double student(size_t degrees)
{
    static const double table[] = {12.71, 12.71, 4.303, 3.182, 2.776, 2.571,
                                   2.447, 2.365, 2.306, 2.262, 2.228};
    const size_t last = sizeof table / sizeof *table - 1;
    /* Beyond ten degrees the first terms of the expansion in 1/n are right to 0.2 %. */
    return degrees <= last ? table[degrees]
                           : 1.95996 + 2.3723 / (double)degrees + 2.82 / (double)(degrees * degrees);
}

/* out = a b a for a symmetric a. */
static void sandwich(size_t n, const double a[][COLUMN_COUNT], const double b[][COLUMN_COUNT],
                     double out[][COLUMN_COUNT])
{
    double half[COLUMN_COUNT][COLUMN_COUNT];
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            half[i][j] = 0.0;
            for (size_t k = 0; k < n; k++) {
                half[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            out[i][j] = 0.0;
            for (size_t k = 0; k < n; k++) {
                out[i][j] += half[i][k] * a[k][j];
            }
        }
    }
}

static void add_square(size_t n, const double *g, double meat[][COLUMN_COUNT])
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            meat[i][j] += g[i] * g[j];
        }
    }
}

/* A shape (knee, share of the ripple) that the rows do not show is known to its order of magnitude. The cause is certain all the same. */
static void hold_shapes(hypothesis_set set, const int *column, size_t members, double *prior)
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (size_t k = 0; hypothesis_in(set, h) && k < hypothesis_table[h].shapes; k++) {
            for (size_t i = 0; i < members; i++) {
                prior[i] = column[i] == (int)hypothesis_table[h].shape[k] ? 1.0 : prior[i];
            }
        }
    }
}

bool certainty_of(fit_data *d, const fit_state *s, certainty *c)
{
    memset(c, 0, sizeof *c);
    c->inflation = 1.0;
    const size_t members = gram_columns(d, s, s->set, c->column);
    double own[COLUMN_COUNT] = {0.0};
    double prior[COLUMN_COUNT][COLUMN_COUNT] = {{0.0}};
    c->columns = last_digits_append(d, s, members, c->column, own);
    hold_shapes(s->set, c->column, members, own);
    for (size_t k = 0; k < c->columns; k++) {
        prior[k][k] = own[k];
    }
    return members == 0 || certainty_under(d, s, (const double(*)[COLUMN_COUNT])prior, members, members, c);
}

/* Sums over all blocks: the curvature, and the scores' outer products by block and by group. */
typedef struct score_sums {
    double curvature[COLUMN_COUNT][COLUMN_COUNT];
    double by_block[COLUMN_COUNT][COLUMN_COUNT];
    double by_group[COLUMN_COUNT][COLUMN_COUNT];
    double score[ROWS_MAX_GROUPS][COLUMN_COUNT];
    double bread[COLUMN_COUNT][COLUMN_COUNT]; /* inverse of the curvature */
    double group_covariance[COLUMN_COUNT][COLUMN_COUNT];
} score_sums;

/* What is known beforehand, and how it varies between drives, is a part of each sum. */
static void add_blocks(const fit_data *d, const gram *grams, const double prior[][COLUMN_COUNT], size_t n,
                       score_sums *sums)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            sums->curvature[i][j] = sums->by_block[i][j] = sums->by_group[i][j] = prior[i][j];
        }
    }
    for (size_t b = 0; b < d->blocks; b++) {
        for (size_t i = 0; i < n; i++) {
            sums->score[grams[b].group][i] += grams[b].g[i];
            for (size_t j = 0; j < n; j++) {
                sums->curvature[i][j] += grams[b].h[i][j];
            }
        }
        add_square(n, grams[b].g, sums->by_block);
    }
    for (size_t g = 0; g < d->rows->groups; g++) {
        add_square(n, sums->score[g], sums->by_group);
    }
}

/* Columns that are not distinguishable here: nothing is certain. */
static void know_nothing(certainty *c)
{
    for (size_t i = 0; i < c->columns; i++) {
        c->covariance[i][i] = UNKNOWN * UNKNOWN;
        c->half_width[i] = UNKNOWN;
    }
}

/* Half widths: the widest of those by white noise, by the scatter of the blocks and by that of the groups. */
static void know_by(const fit_data *d, size_t members, size_t lost, score_sums *sums, certainty *c)
{
    const size_t n = c->columns;
    const size_t groups = d->rows->groups;
    const size_t degrees = d->blocks > lost + 1 ? d->blocks - lost : 0;
    const double few_blocks = degrees > 0 ? (double)d->blocks / (double)degrees : 2.0;
    const double few_groups = groups > 1 ? (double)groups / (double)(groups - 1) : 1.0;
    const double t_blocks = student(degrees > 0 ? degrees : 2);
    const double t_groups = student(groups > 1 ? groups - 1 : 1);
    double ratio = 0.0;
    sandwich(n, (const double(*)[COLUMN_COUNT])sums->bread, (const double(*)[COLUMN_COUNT])sums->by_block,
             c->covariance);
    sandwich(n, (const double(*)[COLUMN_COUNT])sums->bread, (const double(*)[COLUMN_COUNT])sums->by_group,
             sums->group_covariance);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            c->covariance[i][j] *= few_blocks;
        }
        const double plain = NORMAL_95 * sqrt(sums->bread[i][i]);
        const double block = t_blocks * sqrt(c->covariance[i][i]);
        const double group = groups > 3 ? t_groups * sqrt(few_groups * sums->group_covariance[i][i]) : 0.0;
        c->half_width[i] = fmax(plain, fmax(block, group));
        ratio += i < members ? c->covariance[i][i] / sums->bread[i][i] / (double)members : 0.0;
    }
    c->inflation = fmax(1.0, ratio);
}

bool certainty_under(fit_data *d, const fit_state *s, const double prior[][COLUMN_COUNT], size_t members,
                     size_t lost, certainty *c)
{
    gram *grams = gram_blocks(d, s, c->column, c->columns);
    score_sums *sums = calloc(1, sizeof *sums);
    const bool ok = grams && sums;
    if (ok) {
        gram_free_scale(d, s, c->column, c->columns, grams);
        add_blocks(d, grams, prior, c->columns, sums);
        if (solve_covariance(c->columns, COLUMN_COUNT, &sums->curvature[0][0], &sums->bread[0][0])) {
            know_by(d, members, lost, sums, c);
        } else {
            know_nothing(c);
        }
    }
    free(grams);
    free(sums);
    return ok;
}

/* c->columns if the column was not fitted. */
static size_t place_of(const certainty *c, int column)
{
    size_t k = 0;
    while (k < c->columns && c->column[k] != column) {
        k++;
    }
    return k;
}

/* What a column's value takes of each that was fitted: one of itself, or of the coordinates that move jointly. */
static bool parts_of(const certainty *c, int column, double part[COLUMN_COUNT])
{
    const size_t own = place_of(c, column);
    bool any = own < c->columns;
    for (size_t k = 0; k < c->columns; k++) {
        part[k] = k == own ? 1.0 : 0.0;
        if (own == c->columns && column >= P_COUNT && c->column[k] < P_COUNT) {
            double unit[P_COUNT] = {0.0};
            unit[c->column[k]] = 1.0;
            part[k] = column_value(column, unit);
            any = any || part[k] != 0.0;
        }
    }
    return any;
}

/* Covariance of two columns' values, in half widths. */
static double widths_of(const certainty *c, const double *one, const double *other)
{
    double sum = 0.0;
    for (size_t i = 0; i < c->columns; i++) {
        for (size_t j = 0; one[i] != 0.0 && j < c->columns; j++) {
            if (other[j] != 0.0) {
                const double lean =
                    i == j ? 1.0 : c->covariance[i][j] / sqrt(c->covariance[i][i] * c->covariance[j][j]);
                sum += one[i] * other[j] * lean * c->half_width[i] * c->half_width[j];
            }
        }
    }
    return sum;
}

double certainty_half_width(const certainty *c, int column)
{
    double part[COLUMN_COUNT];
    return parts_of(c, column, part) ? sqrt(fmax(widths_of(c, part, part), 0.0)) : 0.0;
}

double certainty_correlation(const certainty *c, int column, int other)
{
    double one[COLUMN_COUNT];
    double two[COLUMN_COUNT];
    if (!parts_of(c, column, one) || !parts_of(c, other, two)) {
        return 0.0;
    }
    return widths_of(c, one, two) / sqrt(widths_of(c, one, one) * widths_of(c, two, two));
}

/* Covariance, scaled to the half widths, of some columns; those not fitted have none. */
static void widths_together(const certainty *c, const int *column, size_t n, double *out)
{
    for (size_t i = 0; i < n; i++) {
        const double half = certainty_half_width(c, column[i]);
        for (size_t j = 0; j < n; j++) {
            const double lean = i == j ? 1.0 : certainty_correlation(c, column[i], column[j]);
            out[i * n + j] = lean * half * certainty_half_width(c, column[j]);
        }
    }
}

double certainty_of_size(const certainty *c, const fit_state *s, hypothesis_id h)
{
    const hypothesis *hypo = &hypothesis_table[h];
    const int *column = hypo->column + hypo->fixed;
    const size_t n = hypo->columns - hypo->fixed;
    double along[HYPOTHESIS_COLUMNS] = {0.0}; /* the size's slope */
    double width[HYPOTHESIS_COLUMNS * HYPOTHESIS_COLUMNS];
    double square = 0.0;
    const double size = hypothesis_size(h, s->z);
    widths_together(c, column, n, width);
    for (size_t k = 0; k < n; k++) {
        /* To both sides, as the size of three gains is another one where the third is zero. One of zero grows to either. */
        const double step = 1e-3 * sqrt(width[k * n + k]);
        const double back = size > 0.0 ? step : 0.0;
        double more[P_COUNT];
        double less[P_COUNT];
        memcpy(more, s->z, sizeof more);
        memcpy(less, s->z, sizeof less);
        column_move(column[k], step, more);
        column_move(column[k], -back, less);
        along[k] = step > 0.0 ? (hypothesis_size(h, more) - hypothesis_size(h, less)) / (step + back) : 0.0;
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            square += along[i] * width[i * n + j] * along[j];
        }
    }
    return sqrt(fmax(square, 0.0));
}

/* The half widths as an ellipsoid about z, along its own axes. */
typedef struct ellipsoid {
    size_t n;
    double square[HYPOTHESIS_COLUMNS]; /* of each half axis, */
    double z[HYPOTHESIS_COLUMNS];      /* and z along it */
} ellipsoid;

/* Of the points nearest to z, each of its length, one for each `pull`, 0 to infinity: the length rises with it. */
static double length_at(const ellipsoid *e, double pull)
{
    double sum = 0.0;
    for (size_t k = 0; k < e->n; k++) {
        const double x = pull * e->z[k] / (e->square[k] + pull);
        sum += x * x;
    }
    return sqrt(sum);
}

static double distance_at(const ellipsoid *e, double pull)
{
    double sum = 0.0;
    for (size_t k = 0; k < e->n; k++) {
        const double off = e->z[k] / (e->square[k] + pull);
        sum += e->square[k] * off * off;
    }
    return sqrt(sum);
}

/* The distance from z to the ball of points no longer than `length`; z lies outside. None, where no point of it is in reach. */
static double distance_to_ball(const ellipsoid *e, double length)
{
    double low = 1e-300;
    double high = 1e300;
    for (int n = 0; n < 100; n++) {
        const double middle = sqrt(low) * sqrt(high);
        if (length_at(e, middle) > length) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return length_at(e, low) > length ? INFINITY : distance_at(e, low);
}

bool certainty_exceeds(const certainty *c, const fit_state *s, hypothesis_id h, double least)
{
    int column[HYPOTHESIS_COLUMNS];
    double axes[HYPOTHESIS_COLUMNS * HYPOTHESIS_COLUMNS];
    ellipsoid e = {.n = hypothesis_length(h, column)};
    const double size = hypothesis_size(h, s->z);
    widths_together(c, column, e.n, axes);
    if (e.n < 2 || size <= least || !solve_symmetric(e.n, axes, e.square)) {
        return size - certainty_of_size(c, s, h) >= least;
    }
    for (size_t k = 0; k < e.n; k++) {
        e.square[k] = fmax(e.square[k], 0.0);
        for (size_t i = 0; i < e.n; i++) {
            e.z[k] += axes[i * e.n + k] * column_value(column[i], s->z);
        }
    }
    return distance_to_ball(&e, least) >= 1.0;
}

double certainty_chi_square(const certainty *c, const fit_state *s, hypothesis_id h)
{
    const hypothesis *hypo = &hypothesis_table[h];
    double part[COLUMN_COUNT][COLUMN_COUNT];
    double z[HYPOTHESIS_COLUMNS];
    double x[HYPOTHESIS_COLUMNS];
    size_t at[HYPOTHESIS_COLUMNS] = {0};
    size_t n = 0;
    for (size_t k = hypo->fixed; k < hypo->columns; k++) {
        for (size_t j = 0; j < c->columns; j++) {
            if (c->column[j] == hypo->column[k]) {
                at[n] = j;
                z[n++] = column_value(hypo->column[k], s->z);
            }
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            part[i][j] = c->covariance[at[i]][at[j]];
        }
    }
    if (n == 0 || !solve_positive(n, COLUMN_COUNT, &part[0][0], z, x)) {
        return hypo->fixed == hypo->columns ? INFINITY : 0.0;
    }
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += z[i] * x[i];
    }
    return sum;
}

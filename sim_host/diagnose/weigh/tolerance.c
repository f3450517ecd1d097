/* Laws that hold to a share, marginalised per operating point (tolerance.h). */
#include "tolerance.h"

#include "base/solve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DIRECTIONS = 16 };

/* A direction in which the law of a member may err, along columns local to a list. */
typedef struct direction {
    cause_id cause;
    bool shape; /* of what shapes it, not of its size */
    double deviation;
    double along[COLUMN_COUNT];
} direction;

static size_t place_of(const int *column, size_t n, int wanted)
{
    size_t k = 0;
    while (k < n && column[k] != wanted) {
        k++;
    }
    return k;
}

typedef struct direction_list {
    size_t count;
    direction at[DIRECTIONS];
} direction_list;

/* Takes a direction in unless the law is exact in it. */
static void add(direction_list *list, const direction *one)
{
    bool moves = false;
    for (size_t i = 0; i < COLUMN_COUNT; i++) {
        moves = moves || one->along[i] != 0.0;
    }
    if (moves && one->deviation > 0.0 && list->count < DIRECTIONS) {
        list->at[list->count++] = *one;
    }
}

static void add_column(direction_list *list, cause_id cause, const int *column, size_t n, int wanted,
                       double deviation)
{
    const size_t at = place_of(column, n, wanted);
    if (at < n) {
        direction one = {.cause = cause, .shape = true, .deviation = deviation};
        one.along[at] = 1.0;
        add(list, &one);
    }
}

static void directions_of(const fit_state *s, const int *column, size_t n, direction_list *list)
{
    list->count = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        const hypothesis *hypo = &hypothesis_table[h];
        if (!hypothesis_in(s->set, h)) {
            continue;
        }
        direction own = {.cause = hypo->cause, .deviation = law_holds_to[hypo->cause]};
        for (size_t k = hypo->fixed; k < hypo->columns; k++) {
            const size_t at = place_of(column, n, hypo->column[k]);
            if (at < n) {
                own.along[at] = column_value(hypo->column[k], s->z);
            }
        }
        add(list, &own);
        for (size_t k = 0; k < hypo->shapes; k++) {
            add_column(list, hypo->cause, column, n, (int)hypo->shape[k],
                       coordinate_table[hypo->shape[k]].wanders);
        }
    }
}

/* One operating point's sums seen along the directions. */
typedef struct seen {
    double h[DIRECTIONS][COLUMN_COUNT]; /* D'H */
    double a[DIRECTIONS][DIRECTIONS];   /* D'HD */
    double g[DIRECTIONS];               /* D'g */
} seen;

static void look_along(const direction *list, size_t count, const gram *sums, size_t n, seen *out)
{
    for (size_t k = 0; k < count; k++) {
        out->g[k] = 0.0;
        memset(out->h[k], 0, sizeof out->h[k]);
        for (size_t i = 0; i < n; i++) {
            if (list[k].along[i] == 0.0) {
                continue;
            }
            out->g[k] += list[k].along[i] * sums->g[i];
            for (size_t j = 0; j < n; j++) {
                out->h[k][j] += list[k].along[i] * sums->h[i][j];
            }
        }
        for (size_t m = 0; m <= k; m++) {
            double sum = 0.0;
            for (size_t j = 0; j < n; j++) {
                sum += out->h[k][j] * list[m].along[j];
            }
            out->a[k][m] = out->a[m][k] = sum;
        }
    }
}

/* Takes out of one point's sums what its laws may err by; returns what that is worth. */
static double deflate(const direction *list, size_t count, const seen *at, size_t n, gram *sums)
{
    /* In units of each deviation, so that M = (1 + A)^-1. */
    double unit[DIRECTIONS * DIRECTIONS];
    double inverse[DIRECTIONS * DIRECTIONS];
    double worth = 0.0;
    for (size_t k = 0; k < count; k++) {
        for (size_t m = 0; m < count; m++) {
            unit[k * count + m] = list[k].deviation * at->a[k][m] * list[m].deviation + (k == m ? 1.0 : 0.0);
        }
    }
    if (!solve_covariance(count, count, unit, inverse) || !solve_factor(count, unit)) {
        return 0.0;
    }
    for (size_t k = 0; k < count; k++) {
        worth -= 2.0 * log(unit[k * count + k]);
    }
    for (size_t k = 0; k < count; k++) {
        double part[COLUMN_COUNT] = {0.0}; /* a row of M D'H, */
        double of_g = 0.0;                 /* and of M D'g */
        for (size_t m = 0; m < count; m++) {
            const double by = list[k].deviation * inverse[k * count + m] * list[m].deviation;
            of_g += by * at->g[m];
            for (size_t j = 0; j < n; j++) {
                part[j] += by * at->h[m][j];
            }
        }
        worth += at->g[k] * of_g;
        sums->c -= at->g[k] * of_g;
        for (size_t i = 0; i < n; i++) {
            sums->g[i] -= at->h[k][i] * of_g;
            for (size_t j = 0; j < n; j++) {
                sums->h[i][j] -= at->h[k][i] * part[j];
            }
        }
    }
    return worth;
}

/* How each effect differs from point to point: its own scale there, less what noise alone would do. */
typedef struct spread {
    double square[DIRECTIONS];
    double points[DIRECTIONS];
} spread;

static void count_spread(const seen *at, size_t count, spread *sum)
{
    for (size_t k = 0; k < count; k++) {
        /* A point that tells the effect's size to a tenth of itself, or more. */
        if (at->a[k][k] > 100.0) {
            const double off = at->g[k] / at->a[k][k];
            sum->square[k] += off * off - 1.0 / at->a[k][k];
            sum->points[k] += 1.0;
        }
    }
}

bool tolerance_sum(const fit_data *d, const fit_state *s, const gram *blocks, const int *column, size_t n,
                   gram *sums, double *worth, double scatter[CAUSE_COUNT])
{
    direction_list *list = malloc(sizeof *list);
    gram *point = malloc(sizeof *point);
    seen *at = malloc(sizeof *at);
    const bool ok = list && point && at;
    if (ok) {
        directions_of(s, column, n, list);
    }
    const size_t count = ok ? list->count : 0;
    spread of_points = {0};
    *worth = 0.0;
    for (size_t group = 0; ok && group < d->rows->groups; group++) {
        memset(point, 0, sizeof *point);
        for (size_t b = 0; b < d->blocks; b++) {
            if (blocks[b].group == group) {
                point->c += blocks[b].c;
                gram_add(point, &blocks[b], n);
            }
        }
        if (count > 0) {
            look_along(list->at, count, point, n, at);
            count_spread(at, count, &of_points);
            *worth += deflate(list->at, count, at, n, point);
        }
        sums->c += point->c;
        gram_add(sums, point, n);
    }
    for (size_t k = 0; scatter && k < count; k++) {
        if (!list->at[k].shape && of_points.points[k] > 1.0) {
            const double mean = of_points.square[k] / of_points.points[k];
            scatter[list->at[k].cause] = mean > 0.0 ? sqrt(mean) : -1.0;
        }
    }
    free(list);
    free(point);
    free(at);
    return ok;
}

bool tolerance_of_state(fit_data *d, const fit_state *s, double *worth)
{
    int column[COLUMN_COUNT];
    const size_t n = gram_columns(d, s, s->set, column);
    gram *blocks = gram_blocks(d, s, column, n);
    gram *sums = calloc(1, sizeof *sums);
    const bool ok = blocks && sums && tolerance_sum(d, s, blocks, column, n, sums, worth, NULL);
    free(blocks);
    free(sums);
    return ok;
}

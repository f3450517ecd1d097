/* One coordinate set free (estimates.h). */
#include "estimates.h"

#include "base/normal.h"
#include "base/solve.h"

#include <math.h>
#include <string.h>

/* A half width is at least this share of `usual`: no recording is without systematic errors. */
static const double LEAST_SHARE = 0.002;

/*
 * And it must be known better than what drives show anyhow (`usual`) from so many rows. More of them say more even where
 * nothing excites it, as the control answers the sensors' own noise: with current along d alone, a second and a half tell
 * L_q to 8 % by that.
 */
static const double ROWS_TO_TELL = 100.0;

static double rows_of(const fit_data *d)
{
    double rows = 0.0;
    for (size_t b = 0; b < d->blocks; b++) {
        rows += (double)d->rows->block[d->block[b]].count;
    }
    return rows;
}

static bool moves_only(hypothesis_id h, coordinate_id id)
{
    return hypothesis_table[h].columns == 1 && hypothesis_table[h].column[0] == (int)id;
}

/*
 * Whether the set moves all others that one factor scales together with the coordinate. Then only the coordinate's own tolerance says which
 * factor it is.
 */
static bool fixes_scale(hypothesis_set set, coordinate_id id)
{
    bool own = false;
    bool others = true;
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        const bool moved = hypotheses_move_scaled(set, k);
        const bool is_own = moves_only(hypotheses_scaled[k], id);
        own = own || (is_own && !moved);
        others = others && (moved || is_own);
    }
    return own && others;
}

estimate estimate_of(const fit_data *d, const evidence_view *view, const fit_state *s, coordinate_id id,
                     double inflation)
{
    const estimate unknown = {.z = s->z[id], .half_width = INFINITY, .excited = false};
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT] = {0.0};
    double rest[P_COUNT];
    double h[COLUMN_COUNT][COLUMN_COUNT];
    double inverse[COLUMN_COUNT][COLUMN_COUNT];
    bool free_already = false;
    for (hypothesis_id k = 0; k < H_COUNT; k++) {
        free_already = free_already || (hypothesis_in(s->set, k) && moves_only(k, id));
    }
    size_t n = last_digits_append(d, s, gram_columns(d, s, s->set, column), column, prior);
    size_t seen = 0;
    for (size_t k = 0; k < n; k++) {
        /* The view does not look at what only shapes a law. */
        if (view->sums.h[column[k]][column[k]] > 0.0) {
            prior[seen] = prior[k];
            column[seen++] = column[k];
        }
    }
    n = seen;
    size_t own = n;
    for (size_t k = 0; k < n; k++) {
        if (column[k] == (int)id) {
            own = k;
            prior[k] = fixes_scale(s->set, id) ? prior[k] : 0.0;
        }
    }
    if (own == n) {
        prior[n] = 0.0;
        column[n++] = (int)id;
    }
    last_digits_rest(s->set, s->z, rest);
    double g[COLUMN_COUNT];
    for (size_t i = 0; i < n; i++) {
        const double digits = column[i] < P_COUNT ? coordinate_table[column[i]].digits : 0.0;
        g[i] = view->sums.g[column[i]] + (prior[i] > 0.0 ? rest[column[i]] / (digits * digits) : 0.0);
        for (size_t j = 0; j < n; j++) {
            h[i][j] = view->sums.h[column[i]][column[j]] + (i == j ? prior[i] : 0.0);
        }
    }
    const double usual = coordinate_usual(id);
    if (!(h[own][own] > 0.0) || !solve_covariance(n, COLUMN_COUNT, &h[0][0], &inverse[0][0])) {
        return unknown;
    }
    /* Along the coordinate: what its own column and the members that move it do. */
    double along[COLUMN_COUNT] = {0.0};
    double step = 0.0;
    double variance = 0.0;
    for (size_t i = 0; i < n; i++) {
        double unit[P_COUNT] = {0.0};
        column_move(column[i], 1.0, unit);
        along[i] = unit[id];
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            step -= along[i] * inverse[i][j] * g[j];
            variance += along[i] * inverse[i][j] * along[j];
        }
    }
    const double deviation = sqrt(fmax(variance, 0.0) * inflation);
    const double half = NORMAL_95 * deviation + LEAST_SHARE * usual;
    const double from_few = deviation * sqrt(fmax(rows_of(d) / ROWS_TO_TELL, 1.0));
    if (!isfinite(half) || half > NORMAL_95 * usual || from_few > usual) {
        return unknown;
    }
    return (estimate){s->z[id] + (free_already ? 0.0 : step), half, true};
}

/* The outlook of an information matrix (plan.h). */
#include "plan.h"

#include "base/normal.h"
#include "base/solve.h"
#include "base/sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The prior: deviation of a parameter, in units of the reporting threshold. It keeps matrices regular. */
static const double UNKNOWN = 100.0;
/* An interval of half of that determines nothing. */
static const double DETERMINED = 0.5;
/* The worst pair counts so many times as much as another. */
static const double WORST_COUNTS = 10.0;

/* The covariance of h and the prior, in units of the reporting thresholds. False if it is none. */
static bool covariance_of(double h[PLAN_ASKED][PLAN_ASKED], double c[PLAN_ASKED][PLAN_ASKED])
{
    for (size_t i = 0; i < PLAN_ASKED; i++) {
        for (size_t j = 0; j < PLAN_ASKED; j++) {
            c[i][j] = h[i][j] * hypothesis_table[plan_asked_list[i].hypothesis].least *
                      hypothesis_table[plan_asked_list[j].hypothesis].least;
        }
        c[i][i] += 1.0 / (UNKNOWN * UNKNOWN);
    }
    return solve_covariance(PLAN_ASKED, PLAN_ASKED, &c[0][0], &c[0][0]);
}

/* The largest correlation of two determined parameters. */
static double worst_pair(double c[PLAN_ASKED][PLAN_ASKED], int worst[2])
{
    const double largest = DETERMINED * UNKNOWN;
    double most = 0.0;
    for (int i = 0; i < PLAN_ASKED; i++) {
        for (int j = 0; j < i; j++) {
            const double r = fabs(c[i][j]) / sqrt(c[i][i] * c[j][j]);
            if (c[i][i] < largest * largest && c[j][j] < largest * largest && r > most) {
                most = r;
                worst[0] = j;
                worst[1] = i;
            }
        }
    }
    return most;
}

double plan_unknown(double h[PLAN_ASKED][PLAN_ASKED])
{
    double c[PLAN_ASKED][PLAN_ASKED];
    int worst[2];
    double sum = 0.0;
    if (!covariance_of(h, c)) {
        return INFINITY;
    }
    for (size_t i = 0; i < PLAN_ASKED; i++) {
        sum += log(c[i][i]);
    }
    const double r = worst_pair(c, worst);
    return sum - WORST_COUNTS * log(1.0 - r * r);
}

static void tell_asked(double h[PLAN_ASKED][PLAN_ASKED], const double unit[PLAN_ASKED], plan_outlook *out)
{
    double c[PLAN_ASKED][PLAN_ASKED];
    double sorted[PLAN_ASKED];
    if (!covariance_of(h, c)) {
        return;
    }
    for (size_t i = 0; i < PLAN_ASKED; i++) {
        out->over_least[i] = NORMAL_95 * sqrt(c[i][i]);
        out->half_width[i] =
            out->over_least[i] * hypothesis_table[plan_asked_list[i].hypothesis].least * unit[i];
        out->determined[i] = out->over_least[i] < DETERMINED * NORMAL_95 * UNKNOWN;
        sorted[i] = out->over_least[i];
    }
    out->worst_correlation = worst_pair(c, out->worst);
    sort_ascending(sorted, PLAN_ASKED);
    out->median_over_least = sorted[PLAN_ASKED / 2];
}

/* ---- Reported causes, and their smallest sizes ---- */

/* Keeps nearly equal columns regular: relative size of the added diagonal. */
static const double REGULAR = 1e-6;
/* If a smaller share of a cause's effect remains, a rival has the same effect. */
static const double SAME = 1e-4;

typedef double square_of[HYPOTHESIS_COLUMNS][HYPOTHESIS_COLUMNS];

static size_t columns_in(const evidence_view *view, hypothesis_id h, int column[HYPOTHESIS_COLUMNS])
{
    size_t n = 0;
    for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
        const int c = hypothesis_table[h].column[k];
        if (column_shows(c, view->rows) && view->total.h[c][c] > 0.0) {
            column[n++] = c;
        }
    }
    return n;
}

/* The information of h's columns when those of a rival are free too: H - C R^-1 C'. rival H_COUNT: none. */
static size_t left_of(const evidence_view *view, hypothesis_id h, hypothesis_id rival, square_of left)
{
    int own[HYPOTHESIS_COLUMNS];
    int other[HYPOTHESIS_COLUMNS];
    square_of r;
    square_of inverse;
    const gram *t = &view->total;
    const size_t n = columns_in(view, h, own);
    const size_t m = rival == H_COUNT ? 0 : columns_in(view, rival, other);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            left[i][j] = t->h[own[i]][own[j]];
        }
    }
    for (size_t i = 0; i < m; i++) {
        for (size_t j = 0; j < m; j++) {
            r[i][j] = t->h[other[i]][other[j]] * (i == j ? 1.0 + REGULAR : 1.0);
        }
    }
    if (m == 0 || !solve_covariance(m, HYPOTHESIS_COLUMNS, &r[0][0], &inverse[0][0])) {
        return n;
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            for (size_t k = 0; k < m; k++) {
                for (size_t l = 0; l < m; l++) {
                    left[i][j] -= t->h[own[i]][other[k]] * inverse[k][l] * t->h[other[l]][own[j]];
                }
            }
        }
    }
    return n;
}

/* The largest size, over `least`, that explains only `needed`, over the directions of the remaining information. */
static double size_of(const evidence_view *view, hypothesis_id h, size_t n, square_of left, double needed)
{
    int column[HYPOTHESIS_COLUMNS] = {0};
    double a[HYPOTHESIS_COLUMNS * HYPOTHESIS_COLUMNS];
    double value[HYPOTHESIS_COLUMNS];
    double most = 0.0;
    (void)columns_in(view, h, column);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            a[i * n + j] = left[i][j];
        }
    }
    if (!solve_symmetric(n, a, value)) {
        return INFINITY;
    }
    for (size_t d = 0; d < n; d++) {
        double z[P_COUNT] = {0.0};
        for (size_t i = 0; i < n; i++) {
            column_move(column[i], a[i * n + d], z);
        }
        const double size = fabs(hypothesis_size(h, z)); /* of a unit step this way */
        if (size > 1e-6) {
            most = fmax(most, size * sqrt(needed / fmax(value[d], 1e-300)));
        }
    }
    return most / hypothesis_table[h].least;
}

static bool is_asked(const evidence_view *view, hypothesis_set possible, hypothesis_id h)
{
    int column[HYPOTHESIS_COLUMNS];
    const hypothesis *hypo = &hypothesis_table[h];
    bool rates = false;
    for (size_t k = 0; k < hypo->columns; k++) {
        rates = rates || column_is_rate(hypo->column[k]);
    }
    return hypothesis_in(possible, h) && hypothesis_cause(h)->named && hypo->fixed == 0 && !rates &&
           columns_in(view, h, column) > 0;
}

static void tell_limits(const evidence_view *view, hypothesis_set possible, plan_outlook *out)
{
    square_of left = {{0.0}};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (!is_asked(view, possible, h)) {
            continue;
        }
        const double needed = evidence_penalty(view, HYPOTHESIS_BIT(h));
        const size_t n = left_of(view, h, H_COUNT, left);
        const double alone = size_of(view, h, n, left, needed);
        double most = alone;
        out->rival[h] = H_COUNT;
        for (hypothesis_id r = 0; r < H_COUNT; r++) {
            if (!is_asked(view, possible, r) || hypothesis_cause(r)->of == hypothesis_cause(h)->of ||
                hypothesis_contains(r, h)) {
                continue;
            }
            (void)left_of(view, h, r, left);
            const double beside = size_of(view, h, n, left, needed);
            if (beside > most) {
                most = beside;
                out->rival[h] = r;
            }
        }
        out->never[h] = most * most * SAME > alone * alone;
        out->limit[h] = fmax(most, 1.0);
    }
}

void plan_outlook_of(const plan_information *info, plan_outlook *out)
{
    double h[PLAN_ASKED][PLAN_ASKED];
    memset(out, 0, sizeof *out);
    memcpy(h, info->h, sizeof h);
    tell_asked(h, info->unit, out);
    tell_limits(&info->view, info->possible, out);
}

bool plan_look(const motor *m, const scenario *s, long seed, plan_outlook *out, error *e)
{
    plan_information *info = calloc(1, sizeof *info);
    if (info == NULL) {
        return error_failure(e, 0, "plan: out of memory");
    }
    const bool ok = plan_information_of(m, s, seed, info, e);
    if (ok) {
        plan_outlook_of(info, out);
    }
    free(info);
    return ok;
}

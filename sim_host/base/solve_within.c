/* A parabola's lowest point within edges (solve.h). */
#include "solve.h"

#include <math.h>

/* Solves for the free variables; the others keep their values. */
static bool solve_free(size_t order, size_t stride, const double *h, const double *b, const bool *held,
                       double *x)
{
    double own[SOLVE_ORDER_MOST * SOLVE_ORDER_MOST];
    double right[SOLVE_ORDER_MOST];
    double found[SOLVE_ORDER_MOST];
    size_t at[SOLVE_ORDER_MOST];
    size_t n = 0;
    for (size_t i = 0; i < order; i++) {
        if (!held[i]) {
            at[n++] = i;
        }
    }
    for (size_t i = 0; i < n; i++) {
        const double *row = h + stride * at[i];
        right[i] = b[at[i]];
        for (size_t j = 0; j < order; j++) {
            right[i] -= held[j] ? row[j] * x[j] : 0.0;
        }
        for (size_t j = 0; j < n; j++) {
            own[SOLVE_ORDER_MOST * i + j] = row[at[j]];
        }
    }
    if (n == 0) {
        return true;
    }
    if (!solve_positive(n, SOLVE_ORDER_MOST, own, right, found)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        x[at[i]] = found[i];
    }
    return true;
}

/* The free one that is farthest beyond its edge, in its own parabola's widths; `order` if none is. */
static size_t farthest_out(size_t order, size_t stride, const double *h, const double *low,
                           const double *high, const bool *held, const double *x)
{
    size_t worst = order;
    double most = 0.0;
    for (size_t i = 0; i < order; i++) {
        const double out = fmax(x[i] - high[i], low[i] - x[i]) * sqrt(h[stride * i + i]);
        if (!held[i] && out > most) {
            most = out;
            worst = i;
        }
    }
    return worst;
}

/* The held one that is drawn back inside most; `order` if none is. */
static size_t drawn_in(size_t order, size_t stride, const double *h, const double *b, const double *high,
                       const bool *held, const double *x)
{
    size_t worst = order;
    double most = 0.0;
    for (size_t i = 0; i < order; i++) {
        double up = b[i];
        double size = fabs(b[i]);
        for (size_t j = 0; j < order; j++) {
            up -= h[stride * i + j] * x[j];
            size = fmax(size, fabs(h[stride * i + j] * x[j]));
        }
        const double in = (x[i] == high[i] ? -up : up) / sqrt(h[stride * i + i]);
        if (held[i] && in > most && fabs(up) > 1e-9 * size) {
            most = in;
            worst = i;
        }
    }
    return worst;
}

bool solve_within(size_t order, size_t stride, const double *h, const double *b, const double *low,
                  const double *high, double *x)
{
    bool held[SOLVE_ORDER_MOST] = {false};
    if (order > SOLVE_ORDER_MOST) {
        return false;
    }
    /* Each goes to its edge and comes back from it a few times at most. */
    for (size_t round = 0; round <= 4 * order; round++) {
        if (!solve_free(order, stride, h, b, held, x)) {
            return false;
        }
        const size_t out = farthest_out(order, stride, h, low, high, held, x);
        if (out < order) {
            held[out] = true;
            x[out] = x[out] > high[out] ? high[out] : low[out];
            continue;
        }
        const size_t in = drawn_in(order, stride, h, b, high, held, x);
        if (in == order) {
            return true;
        }
        held[in] = false;
    }
    for (size_t i = 0; i < order; i++) {
        x[i] = fmin(fmax(x[i], low[i]), high[i]);
    }
    return true;
}

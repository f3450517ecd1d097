/* LAPACK's Cholesky factorisation, scaled so that its pivots can be judged (solve.h). */
#include "solve.h"

#include <lapacke.h>
#include <math.h>

/* Two columns that share all but a millionth of their variance do the same. */
static const double SINGULAR = 1e-6;

/* Factors h with its diagonal scaled to 1; scale[i] = 1 / sqrt(h_ii). */
static bool factor(size_t n, size_t stride, const double *h, double *scale, double *a)
{
    for (size_t i = 0; i < n; i++) {
        if (!(h[i * stride + i] > 0.0)) {
            return false;
        }
        scale[i] = 1.0 / sqrt(h[i * stride + i]);
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            a[i * n + j] = h[i * stride + j] * scale[i] * scale[j];
        }
    }
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', (int)n, a, (int)n) != 0) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        if (a[i * n + i] * a[i * n + i] < SINGULAR) {
            return false;
        }
    }
    return true;
}

bool solve_positive(size_t n, size_t stride, const double *h, const double *b, double *x)
{
    double a[SOLVE_ORDER_MOST * SOLVE_ORDER_MOST];
    double scale[SOLVE_ORDER_MOST];
    if (n == 0 || n > SOLVE_ORDER_MOST || !factor(n, stride, h, scale, a)) {
        return n == 0;
    }
    for (size_t i = 0; i < n; i++) {
        x[i] = b[i] * scale[i];
    }
    if (LAPACKE_dpotrs_work(LAPACK_COL_MAJOR, 'L', (int)n, 1, a, (int)n, x, (int)n) != 0) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        x[i] *= scale[i];
    }
    return true;
}

bool solve_inverse(size_t n, size_t stride, const double *h, double *out)
{
    double a[SOLVE_ORDER_MOST * SOLVE_ORDER_MOST];
    double scale[SOLVE_ORDER_MOST];
    if (n == 0 || n > SOLVE_ORDER_MOST || !factor(n, stride, h, scale, a)) {
        return n == 0;
    }
    if (LAPACKE_dpotri_work(LAPACK_COL_MAJOR, 'L', (int)n, a, (int)n) != 0) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j <= i; j++) {
            out[i * stride + j] = out[j * stride + i] = a[j * n + i] * scale[i] * scale[j];
        }
    }
    return true;
}

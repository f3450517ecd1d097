/*
 * A complex system by Gaussian elimination with row pivoting (solve.h). In real and imaginary parts: a compiler's product and
 * quotient of complex numbers look for infinities, which takes several times as long.
 */
#include "solve.h"

#include <math.h>

enum { WIDEST = SOLVE_GENERAL_MOST + 2 };

/* A row of the matrix and of both right-hand sides. */
typedef struct row {
    double re[WIDEST], im[WIDEST];
} row;

/* r -= f * p, from a column on. */
static void subtract(row *r, double re, double im, const row *p, size_t from, size_t width)
{
    for (size_t k = from; k < width; k++) {
        r->re[k] -= re * p->re[k] - im * p->im[k];
        r->im[k] -= re * p->im[k] + im * p->re[k];
    }
}

/* r times the inverse of its element k, from that column on. False if the element is 0 or not finite. */
static bool divide_by(row *r, size_t k, size_t width)
{
    const double square = r->re[k] * r->re[k] + r->im[k] * r->im[k];
    const double re = r->re[k] / square;
    const double im = -r->im[k] / square;
    for (size_t n = k; n < width; n++) {
        const double before = r->re[n];
        r->re[n] = re * before - im * r->im[n];
        r->im[n] = re * r->im[n] + im * before;
    }
    return isfinite(re) && isfinite(im);
}

/* The row with the largest element of column k comes to place k. */
static void pivot(row **rows, size_t k, size_t order)
{
    size_t largest = k;
    double most = 0.0;
    for (size_t n = k; n < order; n++) {
        const double size = fabs(rows[n]->re[k]) + fabs(rows[n]->im[k]);
        if (size > most) {
            most = size;
            largest = n;
        }
    }
    row *moved = rows[k];
    rows[k] = rows[largest];
    rows[largest] = moved;
}

bool solve_complex_pair(size_t order, const double *a, double *b)
{
    row held[SOLVE_GENERAL_MOST];
    row *rows[SOLVE_GENERAL_MOST];
    const size_t width = order + 2;
    bool ok = order <= SOLVE_GENERAL_MOST;
    for (size_t n = 0; ok && n < order; n++) {
        rows[n] = &held[n];
        for (size_t k = 0; k < width; k++) {
            const double *from = k < order ? &a[2 * (n * order + k)] : &b[2 * (2 * n + k - order)];
            held[n].re[k] = from[0];
            held[n].im[k] = from[1];
        }
    }
    for (size_t k = 0; ok && k < order; k++) {
        pivot(rows, k, order);
        ok = divide_by(rows[k], k, width);
        for (size_t n = k + 1; n < order; n++) {
            if (rows[n]->re[k] != 0.0 || rows[n]->im[k] != 0.0) {
                subtract(rows[n], rows[n]->re[k], rows[n]->im[k], rows[k], k + 1, width);
            }
        }
    }
    for (size_t k = order; ok && k-- > 0;) {
        for (size_t n = 0; n < k; n++) {
            subtract(rows[n], rows[n]->re[k], rows[n]->im[k], rows[k], order, width);
        }
        for (size_t m = 0; m < 2; m++) {
            double *x = &b[2 * (2 * k + m)];
            x[0] = rows[k]->re[order + m];
            x[1] = rows[k]->im[order + m];
            ok = ok && isfinite(x[0]) && isfinite(x[1]);
        }
    }
    return ok;
}

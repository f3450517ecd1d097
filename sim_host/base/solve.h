/* Small symmetric systems, by LAPACK's Cholesky factorisation. */
#ifndef SIM_HOST_BASE_SOLVE_H
#define SIM_HOST_BASE_SOLVE_H

#include <stdbool.h>
#include <stddef.h>

enum { SOLVE_ORDER_MOST = 64 };

/*
 * Solves h x = b for a symmetric positive h of order n <= SOLVE_ORDER_MOST, rows `stride` apart. False if, its
 * diagonal scaled to 1, a pivot is below 1e-6: then two columns do the same.
 */
bool solve_positive(size_t n, size_t stride, const double *h, const double *b, double *x);

/* The inverse of such a matrix, with the same stride. */
bool solve_inverse(size_t n, size_t stride, const double *h, double *out);

#endif

/*
 * Small dense systems of equations, most of them by Eigen (solve*.cpp). Matrices are row by row. Nothing is vectorised
 * and nothing fused, so that every processor gives the same bits.
 */
#ifndef SIM_HOST_BASE_SOLVE_H
#define SIM_HOST_BASE_SOLVE_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SOLVE_ORDER_MOST = 64, SOLVE_GENERAL_MOST = 16 };

/*
 * Solves h x = b for a symmetric positive h of `order` <= SOLVE_ORDER_MOST, rows `stride` apart. False if, its
 * diagonal scaled to 1, a pivot is below 1e-6: then two columns do the same.
 */
bool solve_positive(size_t order, size_t stride, const double *h, const double *b, double *x);

/*
 * Of the same system, written as the lowest point of x h x / 2 - b x: that within low <= x <= high, either infinite where nothing
 * bounds it (solve_within.c). False as above, for what is not at an edge.
 */
bool solve_within(size_t order, size_t stride, const double *h, const double *b, const double *low,
                  const double *high, double *x);

/* The inverse of such a matrix, with the same stride. */
bool solve_inverse(size_t order, size_t stride, const double *h, double *out);

/* The same however alike two columns are. False only where h is not positive in double precision. */
bool solve_covariance(size_t order, size_t stride, const double *information, double *out);

/*
 * The lower factor L of a symmetric positive a = L L^T of `order` <= SOLVE_GENERAL_MOST, in the place of a; only a's lower
 * half is read and written. False if a is not positive.
 */
bool solve_factor(size_t order, double *a);

/* Solves a x = b of `order` <= SOLVE_GENERAL_MOST; x takes the place of b. False if a is singular. */
bool solve_linear(size_t order, const double *a, double *b);

/*
 * The same for complex numbers, each a pair of real and imaginary part, and two right-hand sides side by side. In time with order^3, for a
 * Hessenberg matrix with order^2.
 */
bool solve_complex_pair(size_t order, const double *a, double *b);

/* The eigenvalues of a of `order` <= SOLVE_GENERAL_MOST, in no order. False if a is not finite. */
bool solve_eigenvalues(size_t order, const double *a, double *re, double *im);

/*
 * Writes a = q h q^T with h a Hessenberg matrix (zero below the first subdiagonal), which takes the place of a, and q orthogonal;
 * `order` <= SOLVE_GENERAL_MOST. False if a is not finite.
 */
bool solve_hessenberg(size_t order, double *a, double *q);

/*
 * Eigenvalues, rising, of a symmetric a of `order` <= SOLVE_GENERAL_MOST; only its lower half is read. The eigenvectors, of
 * length 1, take its place as columns. False if a is not finite.
 */
bool solve_symmetric(size_t order, double *a, double *values);

#ifdef __cplusplus
}
#endif

#endif

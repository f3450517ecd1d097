/*
 * Fitting: innovations of the fit blocks, their derivatives, and Gauss-Newton on the likelihood of a set of
 * hypotheses.
 *
 * Each group has its own innovation covariance and filter gain, both estimated along with the parameters. The
 * innovation's derivative by the gain is uncorrelated with that by the parameters (one is made of past noise,
 * the other of the known voltages), so that the two are improved in turn.
 */
#ifndef SIM_HOST_DIAGNOSE_FIT_H
#define SIM_HOST_DIAGNOSE_FIT_H

#include "filter.h"
#include "hypotheses.h"

#include <stdbool.h>

typedef struct group_noise {
    double gain;                 /* of the filter, 1 = trust the sensor alone */
    double cov[3], zero;         /* innovation: aa, ab, bb, and of the three sensors' mean (A^2) */
    double white[3], white_zero; /* whitening: rows of the inverse Cholesky factor 11, 21, 22 */
    double rows;
} group_noise;

typedef struct fit_state {
    hypothesis_set set;
    double z[P_COUNT];
    group_noise noise[ROWS_MAX_GROUPS];
    double objective; /* sum of n log det cov: -2 log likelihood up to a constant */
} fit_state;

typedef struct fit_data {
    diagnose_rows *rows;
    const parameter_set *parameters;
    size_t *block; /* indices of the blocks that are fitted */
    size_t blocks;
    size_t longest; /* rows of the longest block */
    averaged_node *nodes;
    double *base, *moved; /* innovations of one block */
    double *columns;      /* whitened derivatives of one block: [column][3 rows] */
} fit_data;

/* The sums that Gauss-Newton needs of one block: |e|^2, J'e, J'J over the columns asked for. */
typedef struct gram {
    size_t group;
    double c;
    double g[COLUMN_COUNT];
    double h[COLUMN_COUNT][COLUMN_COUNT];
} gram;

/* At most `rows_max` rows are fitted, evenly spread over the recording. */
bool fit_data_make(fit_data *d, diagnose_rows *r, const parameter_set *p, size_t rows_max, bool held_out,
                   error *e);
void fit_data_free(fit_data *d);

/* A start: the motor file's values, every gain one half. */
fit_state fit_nominal(void);

/* Covariances at the state's z and gains; sets the objective. */
void fit_noise(fit_data *d, fit_state *s);

/* One improvement of every group's gain at fixed z, then fit_noise. */
void fit_gain(fit_data *d, fit_state *s);

/* The columns that a set of hypotheses fits, in order; returns how many. With the mean sensor offset where it
 * shows. */
size_t fit_columns(const fit_data *d, const fit_state *s, hypothesis_set set, int column[COLUMN_COUNT]);

/* Sums per fit block at the state, over `n` columns (indices local to the list). False: out of memory. */
gram *fit_grams(fit_data *d, const fit_state *s, const int *column, size_t n);

/* The maximum of the likelihood over the set's parameters, from s->z. */
bool fit_refine(fit_data *d, fit_state *s, int iterations);

/*
 * Solves h x = b for a symmetric positive h of order n (row stride COLUMN_COUNT). False if, its diagonal
 * scaled to 1, a pivot is below 1e-6: then two columns do the same.
 */
bool fit_solve(size_t n, const double h[][COLUMN_COUNT], const double *b, double *x);

/* The inverse of such a matrix. */
bool fit_invert(size_t n, const double h[][COLUMN_COUNT], double out[][COLUMN_COUNT]);

#endif

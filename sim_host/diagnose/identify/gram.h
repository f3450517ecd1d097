/*
 * Sums over blocks: whitened innovations, their derivatives by the columns of hypotheses, and all products of
 * these. Whatever is asked of a fit afterwards is algebra on them.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_GRAM_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_GRAM_H

#include "fit_data.h"

/* A column beside the hypotheses': the gain of the block's own group. */
enum { COLUMN_GAIN = COLUMN_COUNT };

/* What Gauss-Newton needs of one block: |e|^2, J'e, J'J over the columns asked for. */
typedef struct gram {
    size_t group;
    double c;
    double g[COLUMN_COUNT];
    double h[COLUMN_COUNT][COLUMN_COUNT];
} gram;

/* One block's innovations times the group's inverse Cholesky factor; `out` may be `innovation`. */
void gram_whiten(const group_noise *n, size_t rows, const double *innovation, double *out);

/* The columns that a set of hypotheses fits, in order; returns how many. With the mean sensor offset where it
 * shows. */
size_t gram_columns(const fit_data *d, const fit_state *s, hypothesis_set set, int column[COLUMN_COUNT]);

/* Sums per fitted block at the state, over `n` columns, fewer than COLUMN_COUNT with COLUMN_GAIN (indices local to the list).
 * NULL: out of memory. The caller frees. */
gram *gram_blocks(fit_data *d, const fit_state *s, const int *column, size_t n);

/* Adds g and h of the first n columns. */
void gram_add(gram *to, const gram *from, size_t n);

#endif

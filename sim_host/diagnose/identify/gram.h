/*
 * Sums over blocks: of the whitened innovations, their derivatives by the columns of hypotheses, and all products of these (Gram
 * matrices). All later questions to a fit are algebra on these sums.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_GRAM_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_GRAM_H

#include "fit_data.h"

/* One column in addition to those of the hypotheses: the gain of the block's own group. */
enum { COLUMN_GAIN = COLUMN_COUNT };

/* Sums of one block, for Gauss-Newton over the columns asked for: c = |e|^2, g = J'e, h = J'J. */
typedef struct gram {
    size_t group;
    double c;
    double g[COLUMN_COUNT];
    double h[COLUMN_COUNT][COLUMN_COUNT];
} gram;

/* Whitens one block's innovations: multiplies them by the group's inverse Cholesky factor. `out` may be `innovation`. */
void gram_whiten(const group_noise *n, size_t rows, const double *innovation, double *out);

/* The columns that a set of hypotheses fits, in order, and the mean sensor offset if three sensors show it. Returns how many. */
size_t gram_columns(const fit_data *d, const fit_state *s, hypothesis_set set, int column[COLUMN_COUNT]);

/*
 * Sums of each fitted block at the state, over `n` columns; with COLUMN_GAIN there must be fewer than COLUMN_COUNT. The sums' indices
 * are those of the list. NULL: out of memory. The caller frees.
 */
gram *gram_blocks(fit_data *d, const fit_state *s, const int *column, size_t n);

/*
 * No recording tells the factor that R, L, psi_f and all voltages have in common, nor that of R, L and the gains of the current sensors.
 * The sums' difference quotients do, by what they miss at the knees of a dead time. Takes that out, for each factor that the columns
 * follow.
 */
void gram_free_scale(const fit_data *d, const fit_state *s, const int *column, size_t n, gram *grams);

/* Adds g and h of the first n columns. */
void gram_add(gram *to, const gram *from, size_t n);

#endif

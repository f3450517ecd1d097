/*
 * The pieces of a Gauss-Newton step, for the fits of this folder: sums in which each group's gain is solved for, the room of each
 * column, and the step itself.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_STEP_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_STEP_H

#include "gram.h"

/* What one group's sums say of its gain: its own slope and curvature, and how it leans on the columns. */
typedef struct gain_line {
    double down, curve, lean[COLUMN_COUNT];
    bool held;
} gain_line;

/* Sums over all blocks of n columns and, last, COLUMN_GAIN; with every gain that may move solved for. `line` (one a group) and
 * `sum` are zero before. */
void fit_step_sums(const fit_data *d, const fit_state *s, const gram *grams, size_t n, gain_line *line,
                   gram *sum);

/* How far each column may go down and up; one that moves several coordinates has no bound. */
void fit_step_room(const fit_data *d, const fit_state *s, const int *column, size_t n, double *low,
                   double *high);

/* The state after a share of the step, gains included, with its noise. */
fit_state fit_step_taken(fit_data *d, const fit_state *s, const int *column, const double *step, size_t n,
                         const gain_line *line, double share);

#endif

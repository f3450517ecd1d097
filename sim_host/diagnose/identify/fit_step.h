/*
 * The parts of a Gauss-Newton step, for fit.c and whole_fit.c: sums from which each group's gain is eliminated, the bounds of each
 * column, and the step itself.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_STEP_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_STEP_H

#include "gram.h"

/*
 * One group's gain in the sums: its negative slope, its curvature, and its products with the columns. held: the gain does not move.
 */
typedef struct gain_line {
    double down, curve, lean[COLUMN_COUNT];
    bool held;
} gain_line;

/*
 * Sums over all blocks of n columns. `grams` has COLUMN_GAIN as column n; each gain that may move is eliminated. `line` (one per
 * group) and `sum` must be zero before the call.
 */
void fit_step_sums(const fit_data *d, const fit_state *s, const gram *grams, size_t n, gain_line *line,
                   gram *sum);

/* How far each column may move, down and up; a column that moves several coordinates has no bound. */
void fit_step_room(const fit_data *d, const fit_state *s, const int *column, size_t n, double *low,
                   double *high);

/* The state after a share of the step, with the gains that belong to it and its noise. */
fit_state fit_step_taken(fit_data *d, const fit_state *s, const int *column, const double *step, size_t n,
                         const gain_line *line, double share);

#endif

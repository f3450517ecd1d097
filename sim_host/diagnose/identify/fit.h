/*
 * Fitting: Gauss-Newton on the likelihood of a set of hypotheses.
 *
 * The innovation's derivative by the gain is uncorrelated with that by the coordinates (one is made of past
 * noise, the other of the known voltages), so that the two are improved in turn.
 *
 * First the set's own coordinates move alone: while they are far off, the small ones that a motor file's last digits leave
 * open (last_digits.h) would run after them. Then a few joint steps move both, the small ones under their priors.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H

#include "fit_data.h"

/* Covariances at the state's z and gains; sets the objective. */
void fit_noise(fit_data *d, fit_state *s);

/* One improvement of every group's gain at fixed z, then fit_noise. */
void fit_gain(fit_data *d, fit_state *s);

/* The motor file's values with their noise: gains improved until they stand. */
fit_state fit_of_nominal(fit_data *d);

/*
 * The maximum of the likelihood over the set's coordinates, from s->z, in at most `iterations` steps, and then of the
 * likelihood with the priors of what may move unnamed, over both. False: out of memory.
 */
bool fit_refine(fit_data *d, fit_state *s, int iterations);

/*
 * The same, given up where the set's own coordinates leave an objective above `most`, and nothing unnamed is moved then.
 * *alone is what they leave.
 */
bool fit_refine_within(fit_data *d, fit_state *s, int iterations, double most, double *alone);

#endif

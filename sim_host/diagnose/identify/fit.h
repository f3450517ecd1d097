/*
 * Fitting: Gauss-Newton on the likelihood of a set of hypotheses.
 *
 * The innovation's derivative by the gain is uncorrelated with that by the coordinates (one is made of past
 * noise, the other of the known voltages), so that the two are improved in turn.
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

/* The maximum of the likelihood over the set's coordinates, from s->z. False: out of memory. */
bool fit_refine(fit_data *d, fit_state *s, int iterations);

#endif

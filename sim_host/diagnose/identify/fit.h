/*
 * Fitting: Gauss-Newton on the likelihood of a set of hypotheses.
 *
 * Each group's gain moves with the coordinates. Where the model is right the innovation's derivatives by the two are
 * uncorrelated (one is made of past noise, the other of the known voltages); where it is not, a gain that follows the
 * sensors hides what the coordinates are off by, and taken in turn the two would wait for one another.
 *
 * First the set's own coordinates move alone: while they are far off, the small ones that a motor file's last digits leave
 * open (last_digits.h) would run after them. Then a few joint steps move both, the small ones under their priors.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H

#include "fit_data.h"

/* Covariances at the state's z and gains; sets the objective. */
void fit_noise(fit_data *d, fit_state *s);

/* Every group's gain improved at fixed z until it stands. False: out of memory. */
bool fit_gains(fit_data *d, fit_state *s);

/* The motor file's values with their noise: gains improved until they stand. False: out of memory. */
bool fit_of_nominal(fit_data *d, fit_state *s);

/*
 * The maximum of the likelihood over the set's coordinates, from s->z, in at most `iterations` steps, and then of the
 * likelihood with the priors of what may move unnamed, over both. False: out of memory.
 */
bool fit_refine(fit_data *d, fit_state *s, int iterations);

/* How far a fit goes. */
typedef struct fit_aim {
    double enough; /* it ends with a step that promises less of the objective, or finds no way down, */
    double held;   /* or brings what it promised to so much */
    double most;   /* given up where the set's own coordinates leave more than this */
} fit_aim;

/* To rank what is fitted, not to keep it: what one hypothesis pays is ten times as much as is left to find. */
static inline fit_aim fit_ranked(double most)
{
    return (fit_aim){.enough = 3.0, .held = 3.0, .most = most};
}

/* To keep what is fitted. */
static inline fit_aim fit_kept(double most)
{
    return (fit_aim){.enough = 0.3, .held = 0.03, .most = most};
}

/*
 * The same to an aim. *alone: what the set's own coordinates leave; where that is above aim->most nothing unnamed is moved then. NAN,
 * and nothing is moved, where the model gives no number to begin with.
 */
bool fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);

/* The set's own coordinates alone, from s->z: nothing unnamed is moved. False: out of memory. */
bool fit_members(fit_data *d, fit_state *s, int iterations, const fit_aim *aim);

#endif

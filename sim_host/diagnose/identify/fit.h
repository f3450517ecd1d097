/*
 * Fits a set of hypotheses to a recording: Gauss-Newton steps to the maximum of the likelihood.
 *
 * The observer gain of each group moves together with the coordinates. If the model is right, the innovation's derivatives by the two
 * are uncorrelated: one is made of past noise, the other of the known voltages. If the model is wrong, a gain that follows the
 * sensors hides the errors of the coordinates, and estimating the two alternately converges slowly.
 *
 * First the set's own coordinates move alone. While they are far off, the parameter tolerances (last_digits.h) would move to
 * compensate for them. Then a few joint steps move both, the tolerances under their priors.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_FIT_H

#include "fit_data.h"

/* Computes the noise covariances at the state's z and gains, and the objective. */
void fit_noise(fit_data *d, fit_state *s);

/* Improves every group's gain at fixed z until it converges. False: out of memory. */
bool fit_gains(fit_data *d, fit_state *s);

/* The nominal model with its noise: every group's gain is improved until it converges. False: out of memory. */
bool fit_of_nominal(fit_data *d, fit_state *s);

/*
 * Finds the maximum of the likelihood over the set's coordinates, from s->z, in at most `iterations` steps. Then finds the maximum
 * with the priors of the parameter tolerances, over both. False: out of memory.
 */
bool fit_refine(fit_data *d, fit_state *s, int iterations);

/* A fit ends if one of these is true. The objective is -2 log likelihood. */
typedef struct fit_aim {
    double enough; /* the next step predicts at most this reduction of the objective, or there is no step */
    double held;   /* a step's reduction differs from its prediction by at most this */
    double most;   /* given up: the set's own coordinates leave a larger objective */
} fit_aim;

/* For ranking sets: a hypothesis costs ten times the reduction that such a fit may still miss. */
static inline fit_aim fit_ranked(double most)
{
    return (fit_aim){.enough = 3.0, .held = 3.0, .most = most};
}

/* For a fit that is kept. */
static inline fit_aim fit_kept(double most)
{
    return (fit_aim){.enough = 0.3, .held = 0.03, .most = most};
}

/*
 * The same with an aim. *alone: the objective after the set's own coordinates moved alone. If that is above aim->most, the tolerances
 * do not move. NAN: the model has no finite objective at s->z; nothing moves.
 */
bool fit_refine_within(fit_data *d, fit_state *s, int iterations, const fit_aim *aim, double *alone);

/* Fits the set's own coordinates alone, from s->z; the tolerances do not move. False: out of memory. */
bool fit_members(fit_data *d, fit_state *s, int iterations, const fit_aim *aim);

#endif

/*
 * Fits the whole drive: all continuous parameters of the catalogue at once.
 *
 * On a bench every parameter is a little off, and one or two are far off. So each has a heavy-tailed prior: Student's t with two
 * degrees of freedom about the motor file. The scale of the prior is the parameter tolerance times the roughness of the bench. The
 * roughness, 1 to 8, is chosen by evidence (Laplace's approximation). By reweighted least squares, the prior is one more diagonal in
 * the sums of a Gauss-Newton step. Only the prior determines directions in which nothing changes (R, L, psi_f and all voltages by one
 * factor).
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_WHOLE_FIT_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_WHOLE_FIT_H

#include "fit_data.h"

#include <stdio.h>

/*
 * The drives by another factor of R, L, psi_f and all voltages in which the same of these are beyond their reporting thresholds. share: of
 * all, under the prior. factor: on the fit, of the most probable one.
 */
typedef struct drive_scale {
    double share, factor;
} drive_scale;

/* One for each choice of hypotheses_scaled: a bit each. */
enum { DRIVE_SCALES = 1 << HYPOTHESES_SCALED };

typedef struct whole_fit {
    fit_state state; /* its set is that of the start */
    double roughness;
    double inflation; /* variance of the blocks' scores, over that of white noise */
    double goal;      /* -2 log posterior over the inflation, up to a constant */
    size_t columns;
    int column[COLUMN_COUNT];
    double prior[COLUMN_COUNT][COLUMN_COUNT];     /* precision of the prior at the fit, times the inflation */
    double precision[COLUMN_COUNT][COLUMN_COUNT]; /* of the posterior, */
    double covariance[COLUMN_COUNT][COLUMN_COUNT]; /* and its inverse */
    drive_scale scale[DRIVE_SCALES];               /* shares of 0 if the voltages' gain was not fitted */
} whole_fit;

/*
 * Fits what the hypotheses `parts` move, from the state `start`; what else has a tolerance has the motor file's value. `inflation`: a
 * first guess. `trace` may be NULL. False: out of memory.
 */
bool whole_fit_find(fit_data *d, const fit_state *start, hypothesis_set parts, double inflation,
                    whole_fit *out, FILE *trace);

/*
 * Chi square of a hypothesis' parameters against the motor file; 0 if they were not fitted. whole_fit_certain: all others are free
 * under their priors. whole_fit_needed: all others keep their values.
 */
double whole_fit_certain(const whole_fit *f, hypothesis_id h);
double whole_fit_needed(const whole_fit *f, hypothesis_id h);

#endif

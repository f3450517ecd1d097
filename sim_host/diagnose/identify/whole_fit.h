/*
 * The whole drive fitted: every continuous number of the catalogue at once.
 *
 * A bench has everything a little off, and one or two things far. So each number has a heavy-tailed prior, Student's t with two
 * degrees of freedom about the motor file, whose scale is the parameter's tolerance times the roughness of the bench. The
 * roughness, 1 to 8, is chosen by evidence (Laplace's approximation). As reweighted least squares the prior is one more diagonal in
 * the sums of a Gauss-Newton step. Directions in which nothing changes (R, L, psi_f and all voltages scaled alike) are held by
 * the prior and by nothing else.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_WHOLE_FIT_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_WHOLE_FIT_H

#include "fit_data.h"

#include <stdio.h>

typedef struct whole_fit {
    fit_state state; /* its set is that of the start */
    double roughness;
    double inflation; /* how much wider than white noise the scores of blocks scatter, in variance */
    double goal;      /* -2 log posterior over the inflation, up to a constant */
    size_t columns;
    int column[COLUMN_COUNT];
    double pull[COLUMN_COUNT];                     /* precision of the prior about the fit */
    double precision[COLUMN_COUNT][COLUMN_COUNT];  /* of the posterior, */
    double covariance[COLUMN_COUNT][COLUMN_COUNT]; /* and its inverse */
} whole_fit;

/*
 * From a state on, over what the hypotheses `parts` move. `inflation`: a first guess. `trace` may be NULL. False: out of
 * memory.
 */
bool whole_fit_find(fit_data *d, const fit_state *start, hypothesis_set parts, double inflation,
                    whole_fit *out, FILE *trace);

/* Chi square of a hypothesis' numbers against the motor file's, all others free under their priors, or all others as they are;
 * 0 where it was not fitted. */
double whole_fit_certain(const whole_fit *f, hypothesis_id h);
double whole_fit_needed(const whole_fit *f, hypothesis_id h);

#endif

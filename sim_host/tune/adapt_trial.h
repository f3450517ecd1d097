/*
 * Trial of the adaptation (iqfoc/adapt.h): the duty of the change detector's trials. The winding warms by 60 K and
 * the magnet loses 5 %, evenly over the first warming_s. Runs with the adaptation and without.
 */
#ifndef SIM_HOST_TUNE_ADAPT_TRIAL_H
#define SIM_HOST_TUNE_ADAPT_TRIAL_H

#include "tune_design.h"

/* Of the last quarter of the time, percent. */
typedef struct adapt_trial {
    bool alarm;                              /* of the change detector, at any time */
    double r_percent, psi_percent;           /* error of the model's R and psi_f at the end */
    double r_most_percent, psi_most_percent; /* largest error during the run */
    double error_percent;                    /* rms of the model's prediction error, of the rated peak */
    double
        torque_percent; /* rms of the torque by the model's psi_f less the true, of that at the rated peak */
} adapt_trial;

bool adapt_trial_run(const tune_result *r, bool adapted, double warming_s, double seconds, uint64_t seed,
                     adapt_trial *out, error *e);

#endif

/*
 * The adaptation (iqfoc/adapt.h) tried: the duty of the watch's trials by a drive whose winding warms by 60 K and whose
 * magnet loses 5 % evenly over the first warming_s of the time; with the adaptation and without.
 */
#ifndef SIM_HOST_TUNE_ADAPT_TRIAL_H
#define SIM_HOST_TUNE_ADAPT_TRIAL_H

#include "tune_design.h"

/* Of the last quarter of the time, percent. */
typedef struct adapt_trial {
    bool alarm;                    /* of the watch, at any time */
    double r_percent, psi_percent; /* by how much the model's R and psi_f are off the drive's, at the end */
    double r_most_percent, psi_most_percent; /* the same at its worst meanwhile */
    double error_percent;                    /* rms of the model's prediction error, of the rated peak */
    double
        torque_percent; /* rms of the torque by the model's psi_f less the true, of that at the rated peak */
} adapt_trial;

bool adapt_trial_run(const tune_result *r, bool adapted, double warming_s, double seconds, uint64_t seed,
                     adapt_trial *out, error *e);

#endif

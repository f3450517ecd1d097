/*
 * Constants of a design's change detector (iqfoc/watch.h): the noise of the currents, and the uncertainty of the
 * model.
 */
#ifndef SIM_HOST_TUNE_TUNE_WATCH_H
#define SIM_HOST_TUNE_TUNE_WATCH_H

#include "tune_design.h"

typedef struct tune_watch {
    double noise_pu;  /* of a sample of the current's vector, either component */
    double R, L, psi; /* shares of the design's machine */
    double fall; /* share that L falls by up to the rated peak, by the motor file's saturation; 0: none */
    const char *none; /* NULL, or the reason why there is no change detector */
} tune_watch;

/*
 * From a diagnosis: the shares are those of its uncertainty set. noise_pu covers any number of sensors: with two
 * sensors a component has 1.29 times one sensor's noise. A noise below the range of the detector's constants becomes
 * the smallest of that range. L is at least the fall by saturation: the model has the inductances at zero current.
 */
tune_watch tune_watch_of(const tune_result *r);

/* The smallest change of R, L and psi_f that is detected without noise, as shares. */
typedef struct tune_noted {
    double R, L, psi;
} tune_noted;

tune_noted tune_noted_from(const tune_watch *w);

#endif

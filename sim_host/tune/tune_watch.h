/*
 * What the watch of a design (iqfoc/watch.h) takes from what is known of the drive: the noise that its errors are
 * measured by, and by how much the model may be off without having changed.
 */
#ifndef SIM_HOST_TUNE_TUNE_WATCH_H
#define SIM_HOST_TUNE_TUNE_WATCH_H

#include "tune_design.h"

typedef struct tune_watch {
    double noise_pu;  /* of a sample of the current's vector, either component */
    double R, L, psi; /* shares of the design's machine */
    const char *none; /* NULL; or why there is no watch, in words */
} tune_watch;

/*
 * Of a diagnosis: the shares are those of its region. noise_pu is for any number of sensors: where two make the third
 * current, a component has 1.29 of one's noise. A noise that is less than the watch's constants hold becomes the least.
 */
tune_watch tune_watch_of(const tune_result *r);

/* The change of R, of L, of psi_f from which the watch notes it, as shares, were there no noise. */
typedef struct tune_noted {
    double R, L, psi;
} tune_noted;

tune_noted tune_noted_from(const tune_watch *w);

#endif

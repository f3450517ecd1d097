/*
 * The observer of a design (iqfoc/observer.h): bandwidth of its phase-locked loop, gain of its radial correction, and the
 * margins of the current loop without an angle sensor.
 *
 * A slow loop has the larger margins and the smaller noise, but lags while the speed changes: an acceleration of a turns
 * per cycle^2 leaves an angle error of a/(w T)^2 turns. The bandwidth w is therefore the lowest one whose lag is
 * TUNE_LAG_DEG in the stated run-up from standstill to n_max. The gain is, of five, that with the best margin at n_max,
 * where it acts.
 *
 * A steady error of the flux must not lose the lock: its limit is above the largest of the set.
 *
 * Margins and errors are the worst over the design's set of R, L_d and L_q, with both ends of psi_f and a voltage
 * TUNE_TOLERANCE_GAIN too high or too low, at the rated current of both signs.
 */
#ifndef SIM_HOST_TUNE_TUNE_OBSERVER_H
#define SIM_HOST_TUNE_TUNE_OBSERVER_H

#include "tune_design.h"
#include "tune_sensorless.h"

#include "extension_host.h"

#define TUNE_RUN_UP_S       1.0
#define TUNE_LAG_DEG        2.0
#define TUNE_TOLERANCE_GAIN 0.02
#define TUNE_NOISE_SHARE    0.005 /* of the rated peak: a sensor's noise that no diagnosis has measured */

/* From the first speed above standstill to n_max; and bandwidths to choose from. */
enum { TUNE_OBSERVER_SPEEDS = TUNE_SPEEDS - 1, TUNE_OBSERVER_CHOICES = 6 };

/* At one speed. The worst machine of the margin and that of the angle may differ. */
typedef struct tune_observer_speed {
    double rpm, sffr;
    double disk, disk_nominal; /* 0: unstable, or no steady state within half a radian of the true angle */
    double angle_deg;          /* largest steady error; INFINITY: no such steady state */
    double flux_off;           /* largest steady error of the active flux' length, share of psi_f */
    double noise_deg, speed_noise_percent; /* rms, nominal machine at the rated current */
    char disk_worst[160], angle_worst[160];
} tune_observer_speed;

/* Another bandwidth: its run-up for the same lag, its noise, and its worst margin at every other speed. */
typedef struct tune_observer_choice {
    double bandwidth_rad_s, run_up_s, noise_deg, disk;
} tune_observer_choice;

typedef struct tune_observer {
    const char *none; /* NULL, or the reason why there is no observer; nothing below is set then */
    double run_up_s;
    double bandwidth_rad_s;
    bool fastest; /* the bandwidth is 1/T, the highest: the run-up lags more */
    iqfoc_observer_config_t config;
    double gain_max, speed_min;
    double flux_max; /* share of psi_f: the limit above which the lock is lost */
    double noise_A;
    bool noise_measured; /* by the diagnosis */
    int disk_worst;      /* the speed of the worst margin */
    int angle_worst;     /* and of the largest angle error */
    tune_observer_speed at[TUNE_OBSERVER_SPEEDS];
    tune_observer_choice choice[TUNE_OBSERVER_CHOICES];
} tune_observer;

/* Designs the observer of a finished design. run_up_s: from standstill to n_max, > 0. */
void tune_observer_find(const tune_result *r, double run_up_s, tune_observer *o);

#endif

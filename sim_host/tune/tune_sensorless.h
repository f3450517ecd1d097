/*
 * The closed current loop without an angle sensor as one linear system: tuned controller (iqfoc/tuned_control.h), observer
 * (iqfoc/observer.h) and a machine that differs from the model of both, at constant speed and constant current.
 *
 * One cycle is written as a map of the state, in double precision and exact in machine, sampling, hold and delay:
 *
 *     machine      i' = F i + G c v + m,  i_mid alike over half the cycle       c: true over believed voltage
 *     observer     observer.h with the believed voltage v, from the sampled i, i_mid, i'
 *     controller   tuned_control.h at the observed angle and speed; its voltage acts from the next valley on
 *
 * All vectors are seen from the true rotor at their valley, so a steady state is a fixed point of the map. Newton's rule
 * finds it, and the matrix of the loop is the map's derivative there, by central differences. The fixed point has the
 * angle error that the wrong parameters cause. The derivative has their effect on the stability.
 */
#ifndef SIM_HOST_TUNE_TUNE_SENSORLESS_H
#define SIM_HOST_TUNE_TUNE_SENSORLESS_H

#include "tune_loop.h"

#include <stdbool.h>

/* Controller and observer. Both use control.machine. */
typedef struct tune_sensorless {
    tune_design control;
    double k1, k2;   /* of the phase-locked loop */
    double gain_max; /* of the radial correction */
    bool halves;     /* no sample in the middle of a cycle */
} tune_sensorless;

/* A design's controller with an observer of the bandwidth w T. halves: two updates a carrier period. */
tune_sensorless tune_sensorless_of(const tune_design *design, bool halves, double w_T, double gain_max);

/* Where the loop is linearised. */
typedef struct tune_operating_point {
    tune_machine truth;
    double voltage_gain; /* true over believed */
    double phi_rad;      /* electrical angle of a cycle, > 0, <= 2 pi/3 */
    double i_q_A;        /* set-point; that of i_d is 0 */
} tune_operating_point;

enum {
    /* Places of the state in tune_loop.a. Current and voltage are where tune_loop.h has them. */
    TUNE_SENSORLESS_DRIFT = 4,  /* disturbance estimate */
    TUNE_SENSORLESS_OFFSET = 6, /* valley's offset */
    TUNE_SENSORLESS_SEEN = 8,   /* current of the last sample, as the controller sees it */
    TUNE_SENSORLESS_ANGLE = 10, /* observed minus true angle, rad */
    TUNE_SENSORLESS_SPEED = 11, /* observed minus true speed, rad per cycle */
    TUNE_SENSORLESS_FLUX = 12,  /* observed flux linkage */
    TUNE_SENSORLESS_ORDER = 14
};

/* The observer's error. */
typedef struct tune_sensorless_error {
    double angle_rad;     /* steady: observed minus true */
    double flux_off_Wb;   /* steady: expected minus observed length of the active flux, `off` of observer.h */
    double angle_rms_rad; /* by the noise of the samples */
    double speed_rms;     /* the same, rad per cycle */
} tune_sensorless_error;

/*
 * loop: order, a and push, for tune_poles and tune_disk_margin. State n is in units of scale[n], so that the matrix has
 * entries of about 1. False if there is no steady state within half a radian of the true angle.
 *
 * noise_A: standard deviation of one phase's sample, three sensors. off: NULL if it is not wanted; its rms values are
 * INFINITY for an unstable loop.
 */
bool tune_sensorless_make(const tune_sensorless *s, const tune_operating_point *at, double noise_A,
                          tune_loop *loop, tune_sensorless_error *off);

#endif

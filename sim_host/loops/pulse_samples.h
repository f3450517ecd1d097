/* What pulse_run_up.c records, and what is measured from it. */
#ifndef SIM_HOST_LOOPS_PULSE_SAMPLES_H
#define SIM_HOST_LOOPS_PULSE_SAMPLES_H

#include "pulse_run_up.h"

#include <complex.h>

#define PULSE_SAMPLE_S 1e-5

typedef struct pulse_sample {
    double complex i; /* rotor frame, share of the rated peak */
    double w, theta;  /* electrical, rad; theta counts whole turns */
    long edges;       /* of all legs, so far */
    int jumps;        /* of the angles between two rows, so far */
    pulse_run_mode mode;
} pulse_sample;

/*
 * Mean torque about a sample, with weights 1 + cos over 2/3 of a turn, in which all harmonics of the modes vanish. Share of the rated torque.
 */
double pulse_mean_torque(const pulse_sample *at);

/* The torque of pulse_run_up_torque. */
long pulse_samples_torque(const pulse_sample *sample, long count, double i_q, pulse_torque *torque,
                          long capacity);

/* Sets points, trace, modes and the torque errors of the result. */
void pulse_samples_measure(const pulse_sample *sample, long count, const motor *m, double i_q,
                           pulse_run_up *result);

#endif

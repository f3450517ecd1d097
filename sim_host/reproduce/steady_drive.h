/*
 * The 2019 paper's drive in steady state at one speed: the switching-level plant under PWM whose voltage
 * stands still in the rotor frame, chosen so that the current sampled at the mid-point of the cycles is the
 * one asked for. That is where a slow current controller fed by the mid-point sample settles; it is solved
 * for here, because the plant is linear, rather than waited for.
 *
 * Vectors are complex: stationary frame, rotor frame where the name ends in _dq. The machine may be salient.
 */
#ifndef SIM_HOST_REPRODUCE_STEADY_DRIVE_H
#define SIM_HOST_REPRODUCE_STEADY_DRIVE_H

#include "../base/error.h"
#include "../data/motor.h"

#include <complex.h>
#include <stddef.h>

/* One control cycle as it truly was; angles at the cycle's start. */
typedef struct drive_cycle {
    double theta_rad;
    double complex i_valley_A;      /* at its start */
    double complex i_mid_A;         /* at its middle */
    double complex i_next_valley_A; /* at its end */
    double complex i_mean_A;        /* true mean over it */
    double complex i_mean_dq_A;     /* true mean of the current as seen from the turning rotor */
    double complex u_V;             /* mean voltage that the PWM applies: commanded and true alike */
} drive_cycle;

typedef struct steady_drive {
    double T_s;
    double omega_rad_s;        /* electrical */
    double turns_per_cycle;    /* 1/SFFR, signed */
    double complex i_mid_dq_A; /* what was asked for */
    double complex u_dq_V;     /* at mid-cycle */
    double u_dc_V;             /* the motor file's, or more if that cannot hold this point */
    bool link_raised;
    size_t count;
    drive_cycle *cycle;
} steady_drive;

/*
 * Runs about `cycles` control cycles in steady state, rounded to whole beats of carrier and fundamental as
 * far as these meet. i_mid_dq_A is peak, in the rotor frame. False with *e set when memory runs out.
 */
bool steady_drive_run(const motor *m, double n_rpm, double complex i_mid_dq_A, size_t cycles, steady_drive *d,
                      error *e);
void steady_drive_free(steady_drive *d);

/* The duties of a recorded cycle. */
void steady_drive_duties(const steady_drive *d, const drive_cycle *at, double duty[3]);

/* A point of the true waveforms of phase A. */
typedef struct drive_point {
    double t_s;   /* since the first cycle began */
    double u_A_V; /* phase to star point, of the span that ends here */
    double i_A_A;
} drive_point;

typedef void drive_trace(void *context, const drive_point *point);

/* Runs recorded cycles once more and hands the waveforms to `trace`, at every edge and every step_s. */
void steady_drive_trace(const motor *m, const steady_drive *d, size_t first, size_t cycles, double step_s,
                        drive_trace *trace, void *context);

/*
 * The voltage (rotor frame at mid-cycle) and valley current of the steady state without PWM ripple: u
 * constant over each cycle, the mid-point sample at i_mid_dq_A.
 */
typedef struct steady_point {
    double complex i_valley_dq_A, u_dq_V;
} steady_point;

steady_point steady_point_solve(const motor *m, double omega_rad_s, double complex i_mid_dq_A);

/* Highest phase voltage (peak) that PWM with min/max zero sequence makes in linear modulation. */
double steady_drive_voltage_limit(double u_dc_V);

#endif

/*
 * The run-up: the drive of the 2019 paper at 565 V, from standstill to 8000 rpm and down again at rated torque. It
 * goes through overmodulation into six-step with field weakening, in the switching-level plant.
 *
 * Torque is the true mean of each cycle, smoothed by a bell of RUN_UP_BELL cycles, since a cycle's ripple is that of
 * PWM and six-step. Its step is the largest deviation from the set-point above RUN_UP_FROM_RPM, except around the
 * reversal at the top. The linear range ends above that speed.
 */
#ifndef SIM_HOST_LOOPS_RUN_UP_H
#define SIM_HOST_LOOPS_RUN_UP_H

#include "torque_drive.h"

enum { RUN_UP_CASES = 12, RUN_UP_POINTS = 600, RUN_UP_BELL = 64 };

#define RUN_UP_RPM      8000.0
#define RUN_UP_U_DC     565.0
#define RUN_UP_J_KGM2   0.02
#define RUN_UP_FROM_RPM 5500.0
#define RUN_UP_STEP     2.0 /* percent of the rated torque: limit of a transition's step */

typedef struct run_up_case {
    const char *text, *key;
    iqfoc_modulation_t modulation;
    bool midpoint;
    double share;  /* of the largest voltage */
    double ripple; /* of the DC link, amplitude over its mean */
    double ripple_Hz;
    bool by_timer; /* six-step by a timer once it is reached: cycle_six_step.h */
} run_up_case;

extern const run_up_case run_up_cases[RUN_UP_CASES];

/* A point of the run, means over the time of RUN_UP_BELL cycles. */
typedef struct run_up_point {
    double t_s, rpm;
    double torque;   /* over rated */
    double asked;    /* the same, asked for */
    double i_d, i_q; /* over the rated peak */
    double voltage;  /* asked for, over u_dc; the fundamental */
} run_up_point;

typedef struct run_up {
    run_up_point point[RUN_UP_POINTS];
    int points;
    double top_rpm;
    double linear_to_rpm, six_step_from_rpm; /* on the way up, by the voltage asked for; NAN: never reached */
    /* Above RUN_UP_FROM_RPM, percent of the rated torque: largest deviations up and down. */
    double step_up_percent, step_down_percent;
    double i_d_least;                    /* over the rated peak */
    double i_most;                       /* length of a cycle's mean current, the same */
    double voltage_most;                 /* fundamental asked for, over u_dc, of points */
    double to_timer_rpm, to_carrier_rpm; /* where the timer was first taken, last left; NAN: never */
    int transitions;                     /* from the carrier to the timer and back */
    double pulses_top; /* per leg and electrical turn, above 7900 rpm; of six-step by a timer 1 */
} run_up;

/* All of them; false with *e set if the firmware stopped or a drive never reached the top. */
bool run_ups_run(run_up result[RUN_UP_CASES], error *e);

/* The larger of both deviations. */
double run_up_step_percent(const run_up *r);

#endif

/*
 * The drive of the 2016 paper's Section 5: an inverter in six-step mode on a three-phase RL load, solved
 * exactly.
 *
 * The controller applies, of the six active vectors (2/3) u_dc e^{j n pi/3}, the one nearest to a reference at a
 * given angle in the rotor frame, while the rotor turns at constant speed. The reference angle steps once. Within an
 * interval (one inverter state)
 *
 *     i(t) = u/R + (i(0) - u/R) e^{-t/tau},     tau = L/R,
 *
 * so that every mean below is in closed form; the run begins in the exact steady state.
 *
 * Currents are relative to the modulus of the mean phase current in steady state, as the paper's figures are.
 */
#ifndef SIM_HOST_REPRODUCE_SIX_STEP_H
#define SIM_HOST_REPRODUCE_SIX_STEP_H

#include "../base/error.h"

#include <complex.h>
#include <stddef.h>

typedef struct six_step_scenario {
    double L_H, R_ohm;
    double f_Hz;               /* fundamental: 6 f control intervals a second */
    double reference_step_rad; /* of the reference angle, pi/6: the next vector takes over at once */
    double step_at; /* where in a control interval the step falls, 1/2 ... 1: it then cuts the interval */
    int intervals_before; /* complete steady intervals before the one with the step, >= 1 */
    int intervals_after;  /* complete intervals after the step */
} six_step_scenario;

typedef struct six_step_interval {
    double t_s; /* its start; the first interval of the run starts at 0 */
    double duration_s;
    double theta_rad;              /* rotor at its start, not wrapped */
    double Theta_rad;              /* angle covered */
    int vector;                    /* n of the active vector, not wrapped */
    double complex i_start, i_end; /* stationary frame */
    double complex i_mean;         /* stationary frame */
    double complex i_mean_dq;      /* mean of what the turning rotor sees: path B */
} six_step_interval;

typedef struct six_step_run {
    six_step_scenario scenario;
    double complex u_over_R; /* of active vector 0, in the run's current unit */
    double t_step_s;
    size_t count;
    size_t step_index; /* the interval that the step cuts short; those before are steady */
    six_step_interval *interval;
} six_step_run;

/* False only when memory runs out. Free with six_step_free. */
bool six_step_solve(const six_step_scenario *scenario, six_step_run *run, error *e);
void six_step_free(six_step_run *run);

/* The current within an interval, stationary frame, 0 <= t_s <= duration. */
double complex six_step_current(const six_step_run *run, const six_step_interval *at, double t_s);

#endif

/*
 * The three processing paths of 2016, Section 5, over one control interval of the six-step drive: A, the
 * error of the discrete angle as the paper's analysis gives it from the current at both ends; B and C, the
 * true mean and the discrete angle's, from which the error follows without assumptions.
 */
#ifndef SIM_HOST_REPRODUCE_DISCRETE_ANGLE_H
#define SIM_HOST_REPRODUCE_DISCRETE_ANGLE_H

#include "../model/papers.h"
#include "six_step.h"

typedef struct discrete_angle {
    papers_change change; /* (13), (14): of the current as the rotor sees it */
    papers_error path_a;  /* (8), (10)-(12) */
    papers_error path_bc; /* (4) against (3) */
} discrete_angle;

discrete_angle discrete_angle_of(const six_step_interval *at);

/* The same with paths A and C and the change by the firmware's IQ24 functions; B is the truth and stays. */
discrete_angle discrete_angle_of_iq24(const six_step_interval *at);

/* What the paper's Table 2 draws from a run: the steady state, and the largest since the step. */
typedef struct discrete_angle_summary {
    double steady_gain_a, steady_gain_bc;
    double steady_gain_difference, steady_phase_difference_rad;
    double peak_modulus_change, peak_angle_change_rad;
    double peak_gain, peak_phase_rad; /* path A */
    double peak_gain_difference, peak_phase_difference_rad;
} discrete_angle_summary;

typedef discrete_angle discrete_angle_function(const six_step_interval *at);

discrete_angle_summary discrete_angle_summarise(const six_step_run *run, discrete_angle_function *of);

#endif

/*
 * The errors of each method on a steady-state record, as 2019 Section 8 measures them: rms of the error over
 * rms of the phase current, and the largest error of phase A. The phase current is the one sampled at the
 * valleys, from which the methods start: with the mid-point's rms (which differs by 3 % at SFFR 12.5) the
 * paper's Table 1 comes out less well. In double precision and through the firmware's IQ24 functions, from
 * the same samples.
 *
 * The methods are for machines without saliency; for a salient one they get L = (L_d + L_q)/2.
 */
#ifndef SIM_HOST_REPRODUCE_METHOD_ERRORS_H
#define SIM_HOST_REPRODUCE_METHOD_ERRORS_H

#include "steady_drive.h"

#include "../model/papers.h"

#include "iqfoc/predictor.h"

/* What is computed of a cycle, by which method. "Standard" mean: the mid-point sample; prediction: Euler. */
typedef enum method {
    METHOD_MEAN_STANDARD,
    METHOD_MEAN_QUASI_DISCRETE,
    METHOD_PREDICTION_STANDARD,
    METHOD_PREDICTION_QUASI_DISCRETE,
    METHOD_COUNT
} method;

extern const struct method_words {
    const char *quantity, *name;
} method_words[METHOD_COUNT];

/* A machine as the methods see it: in double and as the firmware's constants. */
typedef struct method_machine {
    papers_machine in_double;
    iqfoc_predictor_t in_iq24;
    double I_base_A, U_base_V;
} method_machine;

/* False with the value named if it does not fit IQ24. */
bool method_machine_of(const motor *m, method_machine *machine, error *e);

/* What the controller knows of a cycle when it computes. */
typedef struct method_input {
    double complex i_valley_A, i_mid_A, u_V;
    double theta_rad, omega_rad_s;
} method_input;

method_input method_input_of(const steady_drive *d, const drive_cycle *at);

/* The result in A, stationary frame. */
double complex method_compute(method which, const method_machine *m, const method_input *in);
double complex method_compute_iq24(method which, const method_machine *m, const method_input *in);

/* What it should have been. */
double complex method_truth(method which, const drive_cycle *at);

typedef struct method_error {
    double rms_percent, rms_percent_iq24; /* of the rms phase current */
    double peak_A, peak_A_iq24;           /* of phase A */
    double iq24_off;                      /* largest |IQ24 - double|, of the rated current's peak */
} method_error;

/* Adds a cycle's result in double and in fixed point against the truth; base_A: the rated current's peak. */
void method_error_add(method_error *e, double complex computed, double complex fixed, double complex truth,
                      double base_A);
/* Once all are added: roots and percent. sum_current: of the squares of the currents at the valleys. */
void method_error_finish(method_error *e, double sum_current);

typedef struct method_errors {
    method_error of[METHOD_COUNT];
} method_errors;

method_errors method_errors_of(const steady_drive *d, const method_machine *m);

#endif

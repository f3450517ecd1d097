/*
 * The errors of exact prediction and exact mean on a steady-state record, measured as method_errors.h
 * measures those of the papers' methods, in double precision and through the firmware's IQ24 functions.
 *
 * A machine without saliency is predicted in the stationary frame, a salient one in the rotor frame with its
 * own L_d and L_q. What is left is the PWM's: the methods take the voltage as constant over the cycle.
 */
#ifndef SIM_HOST_REPRODUCE_EXACT_ERRORS_H
#define SIM_HOST_REPRODUCE_EXACT_ERRORS_H

#include "method_errors.h"

typedef struct exact_errors {
    method_error mean, prediction;
} exact_errors;

/* False with the value named if it does not fit IQ24. */
bool exact_errors_of(const motor *m, const steady_drive *d, exact_errors *errors, error *e);

#endif

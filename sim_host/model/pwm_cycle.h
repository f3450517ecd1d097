/*
 * A cycle of centre-aligned PWM, one duty per leg, high around the middle: the duties of a voltage, and the
 * cycle as spans of constant voltage.
 */
#ifndef SIM_HOST_MODEL_PWM_CYCLE_H
#define SIM_HOST_MODEL_PWM_CYCLE_H

#include "../base/vector_complex.h"

/* Duties whose mean voltage is u_V, stationary frame; the highest and the lowest alike far from the rails. */
void pwm_duties(double complex u_V, double u_dc_V, double duty[3]);

/* The cycle's ends, its middle, and the six edges. */
enum { PWM_INSTANTS = 9 };

/* In order, as shares of the cycle; two that coincide leave a span of no length between them. */
void pwm_instants(const double duty[3], double at[PWM_INSTANTS]);

/* Voltage to the star point while the legs are as they are at `at`, a share of the cycle. */
double complex pwm_voltage(const double duty[3], double u_dc_V, double at);

#endif

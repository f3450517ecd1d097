/*
 * A dead time's lost voltage as a time: v_dead = u_dc t_dead f_pwm, so that it compares with the inverter's setting.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_DEAD_TIME_H
#define SIM_HOST_DIAGNOSE_TELL_DEAD_TIME_H

#include "diagnose/result.h"

#include <stddef.h>

/* The parameter v_dead of a dead time; NULL for another cause. */
const diagnosis_parameter *dead_time_of(const diagnosis_cause *cause);

/* "2.00 us at 4 kHz and 420 V", by the motor file's link voltage and PWM frequency. A device drop counts as dead time. */
void dead_time_words(const motor *m, double v_dead_V, char *text, size_t size);

#endif

/*
 * Which currents of a recording are measured. Minus the sum of two stands for a third that is not: always for phase C of a drive with two
 * sensors, or for the phase of the highest duty of a drive with low-side shunts, whose shunt has no time then (pwm_updates.h).
 */
#ifndef SIM_HOST_DATA_CURRENT_SENSORS_H
#define SIM_HOST_DATA_CURRENT_SENSORS_H

#include "pwm_updates.h"
#include "recording.h"

#include <stddef.h>

typedef enum sensor_set {
    SENSORS_THREE,
    SENSORS_TWO,       /* phases A and B */
    SENSORS_TWO_LOWEST /* the two phases of the lower duties */
} sensor_set;

/* The phase of a row that is not measured. */
typedef enum missing_phase { MISSING_NONE, MISSING_A, MISSING_B, MISSING_C, MISSING_PHASES } missing_phase;

/* Three that are measured do not sum to zero; which two are, `pwm` says. */
sensor_set current_sensors_of(const recording *rec, const pwm_updates *pwm);

/* The phase that row k has not measured. history: rows of its stretch before it. */
missing_phase current_sensors_missing(const recording *rec, const pwm_updates *pwm, sensor_set sensors,
                                      size_t k, size_t history);

/* Replaces the missing phase by minus the sum of the other two. */
static inline void current_sensors_leave_out(missing_phase missing, double i[3])
{
    if (missing != MISSING_NONE) {
        const int x = (int)missing - (int)MISSING_A;
        i[x] = -i[(x + 1) % 3] - i[(x + 2) % 3];
    }
}

#endif

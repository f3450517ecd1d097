/*
 * Measures the error reduction in the firmware code: the fixed-point flux predictor over a recording's held-out rows, with the motor file
 * and with the extended motor file.
 *
 *     next = step(correct(sample), acting(u)),     error = sensed(sample(k+1)) - sensed(next)
 *
 * The error is that of the recorded currents, so that it compares with the double-precision one: a corrected prediction is converted back
 * by the sensor model, in double. Effects without a firmware constant stay in the error. For a voltage delay, the row whose voltage acts
 * is used, as in a firmware that stores its commands.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_GAIN_H
#define SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_GAIN_H

#include "base/error.h"
#include "base/json.h"
#include "data/motor.h"
#include "data/recording.h"
#include "firmware_map.h"

typedef struct firmware_gain {
    bool measured;                  /* of one motor file at least */
    double nominal, extended, gain; /* percent of the current's rms, percent, 1; NAN: not measured */
    char reason[512];               /* of a NAN */
    firmware_map map;               /* of the extended motor file */
} firmware_gain;

/* held_out: one flag per row. */
firmware_gain firmware_gain_measure(const recording *rec, const unsigned char *held_out, const motor *nominal,
                                    const motor *extended);

/* Sets the JSON's "firmware": {"nominal", "extended", "gain"} in percent, each null where it cannot be measured; null if none can. */
void firmware_gain_tell(const firmware_gain *g, json_t *json);

#endif

/*
 * What the extension gains in the firmware's own code: the fixed-point flux predictor over a recording's
 * held-out rows, with the motor file as it was and with what the diagnosis made of it.
 *
 *     next = step(correct(sample), acting(u)),     error = sensed(sample(k+1)) - sensed(next)
 *
 * The error is that of the recorded currents, so that it stands beside the double figures: a corrected
 * prediction goes back through the sensor's law, in double, as a test bench would. Effects that the firmware
 * has no constant for stay in the error, but for a voltage that acts late: the row whose voltage acts is
 * taken, as a firmware would that keeps its last commands.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_GAIN_H
#define SIM_HOST_DIAGNOSE_SHOW_FIRMWARE_GAIN_H

#include "base/error.h"
#include "base/json.h"
#include "data/motor.h"
#include "data/recording.h"

typedef struct firmware_gain {
    bool measured;
    double nominal, extended, gain; /* percent of the current's rms, percent, 1 */
    char reason[512];               /* why not, if it was not measured */
} firmware_gain;

/* held_out: one flag per row. */
firmware_gain firmware_gain_measure(const recording *rec, const unsigned char *held_out, const motor *nominal,
                                    const motor *extended);

/* Sets the JSON's "firmware": {"nominal", "extended", "gain"} in percent, or null where it cannot be measured. */
void firmware_gain_tell(json_t *json, const recording *rec, const unsigned char *held_out,
                        const motor *nominal, const motor *extended);

#endif

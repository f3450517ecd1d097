/*
 * The named effects as physics: the switching-level drive with a dead time in seconds, a sensor's gain, a
 * saturating inductance ..., run by the firmware's code through the operating points of a recording.
 *
 * The firmware is told the motor file that the user has, as on the bench. Each run's speed and current
 * references follow the recording's own, as steps of means; sensor noise is as large as the recording's. What
 * comes out is a recording like the measured one, to be diagnosed the same way.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_PLANT_REPLAY_H
#define SIM_HOST_DIAGNOSE_SHOW_PLANT_REPLAY_H

#include "base/error.h"
#include "data/motor.h"
#include "data/recording.h"

#include <stddef.h>

/*
 * nominal: what the firmware knows. extended: what the drive is. noise_A: rms per phase. *out is freed by
 * recording_free; `effect` tells the physics in words. False, with *e set and *out empty, if the drive cannot
 * be driven there.
 */
bool plant_replay(const recording *rec, const motor *nominal, const motor *extended, double noise_A,
                  recording *out, char *effect, size_t size, error *e);

#endif

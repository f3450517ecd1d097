/*
 * Simulates the named causes as physics: the switching-level drive, with a dead time in seconds, a sensor gain or a saturating
 * inductance, runs the firmware code through the operating points of a recording. The firmware uses the user's motor file, as on the test
 * bench. Speed and current references of each run follow the recording as steps of means; the sensor noise is that of the recording. The
 * result is a recording to diagnose like the measured one.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_PLANT_REPLAY_H
#define SIM_HOST_DIAGNOSE_SHOW_PLANT_REPLAY_H

#include "base/error.h"
#include "data/motor.h"
#include "data/recording.h"

#include <stddef.h>

/*
 * nominal: parameters of the firmware. extended: parameters of the drive. noise_A: rms per phase. *out is freed by recording_free;
 * `effect` is the physics in words. False, with *e set and *out empty, if the drive cannot follow the operating points.
 */
bool plant_replay(const recording *rec, const motor *nominal, const motor *extended, double noise_A,
                  recording *out, char *effect, size_t size, error *e);

#endif

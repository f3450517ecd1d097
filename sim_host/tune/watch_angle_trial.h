/*
 * Trials of the watch of the angle sensor (iqfoc/watch_angle.h). The library's control cycle with PI control runs the duty of watch_duty.h
 * on its sensor, with the observer next to it. After half a second the sensor slips or becomes eccentric; an offset is there from the start.
 */
#ifndef SIM_HOST_TUNE_WATCH_ANGLE_TRIAL_H
#define SIM_HOST_TUNE_WATCH_ANGLE_TRIAL_H

#include "watch_trial.h"

#include "iqfoc/watch_angle.h"

/* Errors of the sensor, electrical degrees. */
#define WATCH_ANGLE_OFFSET_DEG    20.0
#define WATCH_ANGLE_SLIP_DEG      40.0
#define WATCH_ANGLE_ECCENTRIC_DEG 8.0 /* amplitude, once per mechanical revolution */

/* The observer's errors that the watch is set for, electrical degrees; the duty's accelerations make most of the bias. */
#define WATCH_ANGLE_BIAS_DEG  5.0
#define WATCH_ANGLE_SWING_DEG 1.5
#define WATCH_ANGLE_NOISE_DEG 0.3

enum { WATCH_ANGLE_FAULTS = IQFOC_WATCH_ANGLE_ECCENTRIC + 1 };

extern const char *const watch_angle_text[WATCH_ANGLE_FAULTS];
extern const char *const watch_angle_key[WATCH_ANGLE_FAULTS];

typedef struct watch_angle_trial {
    int trials;
    int right; /* named within WATCH_CHANGED_S + WATCH_NAMED_S, by the right name; without a fault: no name */
    int early; /* named before the fault */
    double latest_s; /* from the fault to the name; NAN without one */
    double off_deg;  /* largest error of the amount; NAN without one */
} watch_angle_trial;

/* The design's motor runs at its f_pwm_Hz. False with *e set if it has no pole pairs that fit, or cannot be observed. */
bool watch_angle_trial_run(const tune_result *r, iqfoc_watch_angle_fault_t fault, int trials, uint64_t seed,
                           watch_angle_trial *out, error *e);

#endif

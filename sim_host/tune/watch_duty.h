/*
 * The varied duty of the watch's trials: a drive of the motor file with noise and dead time under the tuned firmware; a new acceleration
 * every 50 to 150 ms, new currents every 10 to 50 ms, through both directions, the field weakened where it must be.
 */
#ifndef SIM_HOST_TUNE_WATCH_DUTY_H
#define SIM_HOST_TUNE_WATCH_DUTY_H

#include "tuned_drive.h"
#include "watch_trial.h"

#include "drive/drive_loop.h"

typedef struct watch_duty {
    tuned_firmware_t firmware;
    drive_firmware calls;
    drive_loop loop;
    plant_random random;
    const tune_result *design;
    motor told; /* what the firmware knows */
    double I_A, omega_most, omega;
    double i_d, i_q;                 /* wanted, per unit */
    long speed_until, current_until; /* cycles */
} watch_duty;

bool watch_duty_begin(watch_duty *w, const tune_result *r, uint64_t seed, error *e);

/* phase: of the sensor that changes. */
void watch_duty_change(plant_config *c, watch_change change, int phase);

/* The n-th, from 0. False with *e set if the firmware is gone. */
bool watch_duty_cycle(watch_duty *w, long n, drive_row *row, error *e);

#endif

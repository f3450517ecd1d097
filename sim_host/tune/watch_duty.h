/*
 * The varied duty of the change detector's trials: the motor file's drive with noise and dead time under the tuned
 * firmware. The acceleration changes every 50 to 150 ms, the currents every 10 to 50 ms. The speed goes through both
 * directions, with field weakening at high speed.
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
    watch_condition condition;
    double R_ohm, psi_f_Wb; /* of the drive, at the condition's mean temperature */
    motor model;            /* the firmware's model */
    double I_A, omega_most, omega;
    double i_d, i_q;                 /* wanted, per unit */
    long speed_until, current_until; /* cycles */
} watch_duty;

bool watch_duty_begin(watch_duty *w, const tune_result *r, watch_condition condition, uint64_t seed,
                      error *e);

/* phase: of the sensor or winding that changes. */
void watch_duty_change(plant_config *c, watch_change change, int phase);

/* The n-th, from 0. False with *e set if the firmware stopped. */
bool watch_duty_cycle(watch_duty *w, long n, drive_row *row, error *e);

#endif

/*
 * Firmware with the tuned controller (iqfoc/tuned_control.h) behind the same calls as the control cycle. All
 * that runs at valley and peak is the library's fixed point.
 */
#ifndef SIM_HOST_TUNE_TUNED_DRIVE_H
#define SIM_HOST_TUNE_TUNED_DRIVE_H

#include "tune_loop.h"

#include "data/motor.h"
#include "drive/firmware.h"

#include "iqfoc/extension.h"
#include "iqfoc/tuned_control.h"
#include "iqfoc/watch.h"

typedef struct tuned_drive {
    iqfoc_tuned_law_t law;
    iqfoc_tuned_state_t state;
    iqfoc_ab_t u_now, u_next; /* of the cycle that runs and of the next */
    iqfoc_command_t command;
    bool extended; /* duties are corrected for the legs' losses */
    iqfoc_extension_t extension;
    bool watched;
    iqfoc_watch_config_t watch_config;
    iqfoc_watch_t watch;
    iqfoc_dq_t i_start, u_start; /* of the cycle that runs, seen from the rotor at its start */
    long named;                  /* times that the watch has named a group */
} tuned_drive;

/* A motor with the machine of a region in place of its own, and without extensions. */
motor tuned_motor(const motor *m, const tune_machine *machine);

/*
 * The law of a design for a motor's bases. False where a value does not fit the library's ranges; *e then
 * names the motor file and the key.
 */
bool tuned_law_of(const motor *m, const tune_design *design, iqfoc_tuned_law_t *law, error *e);

bool tuned_drive_init(tuned_drive *t, const motor *m, const tune_design *design, error *e);

/* Corrections of dead time as the motor file has them. */
bool tuned_drive_extend(tuned_drive *t, const motor *m, error *e);

/*
 * A watch for the machine of the design, once tuned_drive_init took it. noise_A: standard deviation of one
 * current sample, 0.0025 ... 0.1 of the rated peak.
 */
void tuned_drive_watch(tuned_drive *t, const motor *m, const tune_machine *machine, double noise_A);

drive_firmware tuned_drive_firmware(tuned_drive *t);

#endif

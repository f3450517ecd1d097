/*
 * Firmware with the tuned controller (iqfoc/tuned_control.h) behind the same calls as the control cycle. All
 * that runs at valley and peak is the library's fixed point.
 */
#ifndef SIM_HOST_TUNE_TUNED_DRIVE_H
#define SIM_HOST_TUNE_TUNED_DRIVE_H

#include "tune_loop.h"

#include "data/motor.h"
#include "drive/firmware.h"

#include "iqfoc/tuned_control.h"

typedef struct tuned_drive {
    iqfoc_tuned_law_t law;
    iqfoc_tuned_state_t state;
    iqfoc_ab_t u_now, u_next; /* of the cycle that runs and of the next */
    iqfoc_command_t command;
} tuned_drive;

/* A motor with the machine of a region in place of its own, and without extensions. */
motor tuned_motor(const motor *m, const tune_machine *machine);

/*
 * The law of a design for a motor's bases. False where a value does not fit the library's ranges; *e then
 * names the motor file and the key.
 */
bool tuned_law_of(const motor *m, const tune_design *design, iqfoc_tuned_law_t *law, error *e);

bool tuned_drive_init(tuned_drive *t, const motor *m, const tune_design *design, error *e);

drive_firmware tuned_drive_firmware(tuned_drive *t);

#endif

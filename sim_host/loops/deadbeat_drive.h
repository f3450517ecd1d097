/*
 * The library's control cycle with deadbeat control as firmware: constants from a motor file, and the slower task for
 * a machine that saturates.
 */
#ifndef SIM_HOST_LOOPS_DEADBEAT_DRIVE_H
#define SIM_HOST_LOOPS_DEADBEAT_DRIVE_H

#include "drive/firmware_host.h"

#include "data/motor.h"

typedef struct deadbeat_drive {
    drive_host host;
    drive_firmware cycle; /* the library's, behind its calls */
    iqfoc_extension_t extension;
    iqfoc_exact_winding_t winding; /* at zero current */
    iqfoc_exact_law_t law;         /* of the set that the drive starts with */
    /* Sets that follow saturation, each with its law; offered in turn. */
    iqfoc_cycle_config_t spare[2];
    iqfoc_exact_law_t spare_law[2];
    int free; /* the one to be filled next */
} deadbeat_drive;

/*
 * assumed: the firmware's motor. model: Euler, quasi-discrete or exact. learning: observer gain, or 0 for plain
 * deadbeat control. extended: use the file's corrections of samples and dead time, and of the inductance with the
 * exact model. False with *e set if a value does not fit the library's ranges.
 */
bool deadbeat_drive_init(deadbeat_drive *d, const motor *assumed, iqfoc_model_t model, double learning,
                         bool extended, error *e);

/* The firmware, started. */
drive_firmware deadbeat_drive_firmware(deadbeat_drive *d);

#endif

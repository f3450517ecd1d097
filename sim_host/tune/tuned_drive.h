/*
 * The tuned firmware (port/emulated/tuned_firmware.h) of a motor file and a design, behind the same calls as the
 * control cycle.
 */
#ifndef SIM_HOST_TUNE_TUNED_DRIVE_H
#define SIM_HOST_TUNE_TUNED_DRIVE_H

#include "tune_watch.h"

#include "data/motor.h"
#include "drive/firmware.h"

#include "tuned_firmware.h"

/* A motor with another machine in place of its own, and without extensions. */
motor tuned_motor(const motor *m, const tune_machine *machine);

/* Starts the firmware. Add corrections and the change detector by the calls below, before it runs. */
bool tuned_drive_init(tuned_firmware_t *t, const motor *m, const tune_design *design, error *e);

/* The motor file's corrections of dead time. */
bool tuned_drive_extend(tuned_firmware_t *t, const motor *m, error *e);

/* A change detector for the machine of the design, after tuned_drive_init succeeded. known->none is NULL. */
void tuned_drive_watch(tuned_firmware_t *t, const motor *m, const tune_machine *machine,
                       const tune_watch *known);

drive_firmware tuned_drive_firmware(tuned_firmware_t *t);

#endif

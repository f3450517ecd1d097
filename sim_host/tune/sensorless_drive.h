/*
 * The tuned firmware (port/emulated/tuned_firmware.h) on the angle of the observer, behind the same calls as the control
 * cycle. The observer begins at the measured angle; after that it has currents and voltages only. The measured angle is
 * used to tell the observer's error.
 */
#ifndef SIM_HOST_TUNE_SENSORLESS_DRIVE_H
#define SIM_HOST_TUNE_SENSORLESS_DRIVE_H

#include "tuned_drive.h"

#include "base/spread.h"

#include "iqfoc/observer.h"

#include <stdbool.h>

typedef struct sensorless_drive {
    tuned_firmware_t tuned;
    iqfoc_observer_config_t config;
    iqfoc_observer_t observer;
    bool halves;         /* two updates a period: no sample in the middle of a cycle */
    double voltage_gain; /* true over measured DC link; 1: no error */
    iqfoc_ab_t i_start;  /* at the start of the cycle that runs */
    iqfoc_ab_t i_middle; /* at its middle */
    long cycle;          /* of those so far */
    long from;           /* the first that counts for `off` and `faster` */
    spread off;          /* observed minus measured angle, turns */
    spread faster;       /* observed minus measured speed, turns per cycle */
    double largest;      /* length of the angle's error from the first cycle on, turns */
    bool lost;           /* the lock was lost */
} sensorless_drive;

/*
 * m: the motor that the firmware believes in, without extensions. False as tuned_drive_init. The observer's error counts
 * from the cycle `from` on.
 */
bool sensorless_drive_init(sensorless_drive *d, const motor *m, const tune_design *design,
                           const iqfoc_observer_config_t *config, long from, error *e);

drive_firmware sensorless_drive_firmware(sensorless_drive *d);

#endif

/*
 * The library in this program as firmware: its control cycle, called through its HAL as a port's interrupts
 * call it, by the methods that are named.
 */
#ifndef SIM_HOST_DRIVE_FIRMWARE_HOST_H
#define SIM_HOST_DRIVE_FIRMWARE_HOST_H

#include "firmware.h"

#include "hal_host.h"

#include "iqfoc/cycle_six_step.h"
#include "iqfoc/extension.h"
#include "iqfoc/sensorless.h"

typedef struct drive_host {
    iqfoc_hal_t hal;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
    iqfoc_methods_t methods;
    bool of_papers;                     /* feedback and modulation are the configuration's */
    const iqfoc_extension_t *extension; /* NULL: the configuration's */
    bool observed;                      /* the angle is the observer's; the rest is used then */
    iqfoc_observer_config_t observer;
    iqfoc_extension_t acting;
    iqfoc_sensorless_t sensorless;
} drive_host;

/* The papers' methods, feedback and modulation as the configuration says. host and extension must outlive the
 * firmware; start makes host ready, whatever it held. extension: NULL or what a diagnosis found, to be put right. */
drive_firmware drive_firmware_host(drive_host *host, const iqfoc_extension_t *extension);

/*
 * The firmware of `host` runs on the observed angle, once the observer is locked; it begins at the measured one. Observer
 * and dead time as in the motor file. False with *e set if it cannot be observed.
 */
bool drive_host_observe(drive_host *host, const motor *m, error *e);

/* A state of six-step by a timer as an answer. */
drive_answer drive_answer_of_state(const iqfoc_cycle_t *cycle, const iqfoc_six_step_command_t *state);

/* Any methods; the configuration brings what they need. */
drive_firmware drive_firmware_by(drive_host *host, iqfoc_methods_t methods);

#endif

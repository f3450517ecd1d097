/*
 * The library in this program as firmware: its control cycle, called through its HAL as a port's interrupts
 * call it; with what a diagnosis found put right around it, if asked for (iqfoc/extension.h).
 */
#ifndef SIM_HOST_DRIVE_FIRMWARE_HOST_H
#define SIM_HOST_DRIVE_FIRMWARE_HOST_H

#include "firmware.h"

#include "hal_host.h"

#include "iqfoc/extension.h"

typedef struct drive_host {
    iqfoc_hal_t hal;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
    iqfoc_methods_t methods;
    const iqfoc_extension_t *extension; /* NULL: none */
} drive_host;

/* host and extension must outlive the firmware; start makes host ready, whatever it held. extension: NULL or
 * what is put right. */
drive_firmware drive_firmware_host(drive_host *host, const iqfoc_extension_t *extension);

#endif

/*
 * The library's control cycle with the corrections of a motor file around it (iqfoc/extension.h), as firmware
 * for closed loops.
 */
#ifndef SIM_HOST_LOOPS_CORRECTED_CYCLE_H
#define SIM_HOST_LOOPS_CORRECTED_CYCLE_H

#include "drive.h"

#include "iqfoc/extension.h"

typedef struct corrected_cycle {
    iqfoc_cycle_config_t config;
    iqfoc_cycle_t cycle;
    iqfoc_extension_t extension;
} corrected_cycle;

/* PI fed by the mid-point sample, its usual bandwidth. The cycle's own trips are off. */
bool corrected_cycle_init(corrected_cycle *c, const motor *assumed, const char *path, error *e);

drive_firmware corrected_cycle_firmware(corrected_cycle *c);

#endif

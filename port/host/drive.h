/*
 * The firmware in a closed loop with the switching-level drive, cycle by cycle: what `iqfoc simulate` runs.
 *
 * The firmware stands behind two calls, so that the same loop drives the library linked into this program or
 * an image on an emulated processor. Timing as in the 2019 paper, Figs 3 to 5: samples at valley and peak,
 * duties computed after the peak of cycle k act from valley k + 1.
 */
#ifndef PORT_HOST_DRIVE_H
#define PORT_HOST_DRIVE_H

#include "data/recording.h"
#include "hal_host.h"

/* The firmware under test. Each call returns false, with *e set, if the firmware is gone (a crashed image).
 */
typedef struct drive_firmware {
    void *context;
    bool (*start)(void *context, const iqfoc_cycle_config_t *config, error *e);
    bool (*reference)(void *context, iqfoc_dq_t i_ref, error *e);
    bool (*valley)(void *context, const iqfoc_sample_t *sample, error *e);
    bool (*peak)(void *context, const iqfoc_sample_t *sample, iqfoc_command_t *command, uint32_t *status,
                 error *e);
} drive_firmware;

/* The library in this program, called through its HAL. */
typedef struct drive_host {
    iqfoc_hal_t hal;
    iqfoc_cycle_t cycle;
    iqfoc_cycle_config_t config;
} drive_host;

/* One control cycle as it was: for recordings and figures. */
typedef struct drive_row {
    long run;
    plant_samples valley; /* what the sensors delivered */
    plant_samples peak;
    double duty[3];    /* in force during the cycle */
    plant_means truth; /* true means over the cycle */
} drive_row;

typedef struct drive_log {
    void *context;
    bool (*row)(void *context, const drive_row *row, error *e);
} drive_log;

/*
 * Runs one run of a scenario: settling cycles, then the logged ones. drive: configured by the caller (motor,
 * effects, sensors, seed); shaft, DC link and references are set from the run. status collects the firmware's
 * sticky bits. False with *e set if the firmware tripped (by name and time) or is gone, or the log refused a
 * row.
 */
bool drive_run(const motor *m, const plant_config *drive, const scenario_run *run, long run_number,
               const iqfoc_cycle_config_t *config, const drive_firmware *firmware, const drive_log *log,
               uint32_t *status, error *e);

/* The firmware of this program. */
drive_firmware drive_firmware_host(drive_host *host);

/* "MISSED | STALE": the names of status bits, "none" for 0. */
const char *drive_status_text(uint32_t status, char *text, size_t size);

#endif

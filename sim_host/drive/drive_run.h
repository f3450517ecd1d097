/*
 * A run of a scenario: shaft, load and references of each control cycle, the settling cycles ahead of it, and
 * the end of it where the firmware stops the drive.
 */
#ifndef SIM_HOST_DRIVE_DRIVE_RUN_H
#define SIM_HOST_DRIVE_DRIVE_RUN_H

#include "data/scenario.h"
#include "drive_loop.h"

/* Gets every logged cycle. */
typedef struct drive_log {
    void *context;
    bool (*row)(void *context, const drive_row *row, error *e);
} drive_log;

/*
 * Runs one run of a scenario: settling cycles, then the logged ones. drive: configured by the caller (motor, effects, sensors, seed, what
 * the clock shows at the first logged cycle); shaft, DC link and references are set from the run. status collects the firmware's sticky
 * bits. False with *e set if the firmware tripped (by name and time) or is gone, or the log refused a row.
 */
bool drive_run(const motor *m, const plant_config *drive, const scenario_run *run, long run_number,
               const iqfoc_cycle_config_t *config, const drive_firmware *firmware, const drive_log *log,
               uint32_t *status, error *e);

/*
 * The same in its parts, for who goes through a run at his own pace: `begin`, then for each control cycle k, from
 * -settle_cycles on, `cycle`, a span of drive_loop.h with the references that it returns, and `stopped`.
 *
 * cycle: sets shaft, load and references of the cycle that begins at k T; while k < 0 they stand as they do at t = 0, without
 * the excitation. stopped: true with *e set if the answer to the row is that the gates are off.
 */
bool drive_run_begin(drive_loop *l, const motor *m, const plant_config *drive, const scenario_run *run,
                     const iqfoc_cycle_config_t *config, const drive_firmware *firmware, error *e);
iqfoc_dq_t drive_run_cycle(drive_loop *l, const motor *m, const scenario_run *run, long k);
bool drive_run_stopped(const drive_row *row, error *e);

#endif

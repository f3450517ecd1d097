/*
 * A firmware for `iqfoc simulate`: the library's control of a pulse pattern, with a table that is computed at the start (docs/scenario.md).
 */
#ifndef SIM_HOST_PATTERNS_PATTERN_DRIVE_H
#define SIM_HOST_PATTERNS_PATTERN_DRIVE_H

#include "data/scenario.h"
#include "drive/firmware.h"
#include "patterns_table.h"

#include "iqfoc/pattern_control.h"

/* Least time between two edges of a leg. */
#define PATTERN_DRIVE_LEAST_S 5e-6

typedef struct pattern_drive {
    const motor *m;
    const scenario *s;
    const char *path; /* of the scenario */
    iqfoc_pattern_row_t row[PATTERNS_ROWS];
    iqfoc_pattern_t table;
    iqfoc_pattern_control_config_t config;
    iqfoc_pattern_control_t control;
    iqfoc_pattern_edges_t edges[3]; /* of the next cycle */
    size_t run;                     /* that runs, from 1 */
    long cycle;                     /* of it, settling included */
    iq24_t speed;                   /* at the last valley */
} pattern_drive;

/*
 * Computes the table of a scenario with modulation = "pattern". Motor, scenario, path and *d must outlive the firmware. False with *e
 * set: a salient machine, values that do not fit the library's ranges, or no memory. The firmware refuses a speed, a reference or a
 * link at which its pattern cannot work, with line and column of the run.
 */
bool pattern_drive_begin(pattern_drive *d, const motor *m, const scenario *s, const char *path,
                         drive_firmware *firmware, error *e);

#endif

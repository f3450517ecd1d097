/*
 * The interface of a firmware: one loop runs the library linked into this program, an image on an emulated processor, or the controller of a study.
 */
#ifndef SIM_HOST_DRIVE_FIRMWARE_H
#define SIM_HOST_DRIVE_FIRMWARE_H

#include "base/error.h"

#include "iqfoc/cycle.h"
#include "iqfoc/pattern.h"

#include <stdbool.h>
#include <stddef.h>

/* What the firmware answers to the last sample of a span. */
typedef struct drive_answer {
    iqfoc_command_t command; /* in force from the end of the span */
    uint32_t status;         /* IQFOC_STATUS_*, sticky */
    /* 0: duties of a control cycle of PWM; else the legs, each 0 or 1, of a state that stands for so long. */
    double interval_s;
    /* NULL, or the edges of the legs in a control cycle in place of the duties, which are then the shares of the cycle at the high level. */
    const iqfoc_pattern_edges_t *edges;
} drive_answer;

/*
 * Each call returns false, with *e set, if the firmware is gone (a crashed image). i_ref: the references of
 * the span, per unit.
 */
typedef struct drive_firmware {
    void *context;
    /* Once, ahead of a scenario's run; NULL where none is run. */
    bool (*start)(void *context, const iqfoc_cycle_config_t *config, error *e);
    /* At the start of a control cycle; never in six-step. */
    bool (*valley)(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, error *e);
    /* At its middle; in six-step at the end of an interval. */
    bool (*peak)(void *context, iqfoc_dq_t i_ref, const iqfoc_sample_t *sample, drive_answer *answer,
                 error *e);
} drive_firmware;

/* "MISSED | STALE": the names of status bits, "none" for 0. */
const char *drive_status_text(uint32_t status, char *text, size_t size);

#endif

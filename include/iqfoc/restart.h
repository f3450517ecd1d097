/*
 * What happens after a break or a trip: what stays off for good, what is tried again, how long after and how
 * often.
 *
 *     RUNNING -> a fault -> WAITING (wait_cycles without the cause) -> TRY -> RUNNING
 *                        -> LATCHED: one that may not be tried again, or tries used up; until acknowledged
 *
 * Each time the step says TRY, the firmware clears the break latch and the cycle and enables the drive again:
 *
 *     switch (iqfoc_restart_step(&restart, faults)) {
 *     case IQFOC_RESTART_TRY: port_clear_break(); iqfoc_cycle_clear(&cycle); cycle.enabled = true; break;
 *     case IQFOC_RESTART_RUN: break;
 *     default: cycle.enabled = false; break;
 *     }
 *
 * faults: the cycle's status bits that trip, those of iqfoc/supervision.h, the break input. While it waits a
 * latch that only clearing ends must not be among them: pass what is still there (the break line's level, the
 * DC link), and pass the bits of a trip once.
 */
#ifndef IQFOC_RESTART_H
#define IQFOC_RESTART_H

#include "error.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_restart_config {
    uint32_t may_restart;   /* bits after which the drive may try again; every other one latches */
    uint32_t wait_cycles;   /* without a fault ahead of a try: 1 ... 2^31 */
    uint32_t tries;         /* in a row; 0: none, every fault latches */
    uint32_t forget_cycles; /* without a fault after which the tries count anew: 1 ... 2^31 */
} iqfoc_restart_config_t;

typedef enum iqfoc_restart_action {
    IQFOC_RESTART_RUN,    /* nothing wrong */
    IQFOC_RESTART_WAIT,   /* off, and it may come back */
    IQFOC_RESTART_TRY,    /* once: clear and go on */
    IQFOC_RESTART_LATCHED /* off, until somebody acknowledges */
} iqfoc_restart_action_t;

/* Read what you like. */
typedef struct iqfoc_restart {
    const iqfoc_restart_config_t *config;
    iqfoc_restart_action_t action; /* the last step's */
    uint32_t faults;               /* all bits since the last acknowledgement */
    uint32_t quiet;                /* cycles without a fault */
    uint32_t tried;                /* tries in a row */
} iqfoc_restart_t;

/* Begins running. config must outlive it. IQFOC_ERROR_RESTART: a field out of its range. */
iqfoc_error_t iqfoc_restart_init(iqfoc_restart_t *restart, const iqfoc_restart_config_t *config);

/* Once a cycle, with the faults of this moment. */
iqfoc_restart_action_t iqfoc_restart_step(iqfoc_restart_t *restart, uint32_t faults);

/*
 * Somebody has seen why it latched. The drive then waits, as after a fault that may be tried again. Nothing
 * happens where it is not latched.
 */
void iqfoc_restart_acknowledge(iqfoc_restart_t *restart);

#ifdef __cplusplus
}
#endif

#endif

/*
 * Restart after a break or a trip: which faults latch, which are tried again, after what time and how often.
 *
 *     RUNNING -> a fault -> WAITING (wait_cycles without the cause) -> TRY -> RUNNING
 *                        -> LATCHED: a fault that may not be tried again, or no tries left; until acknowledged
 *
 * When the step returns TRY, the firmware clears the break latch and the cycle and enables the drive again:
 *
 *     switch (iqfoc_restart_step(&restart, faults)) {
 *     case IQFOC_RESTART_TRY: port_clear_break(); iqfoc_cycle_clear(&cycle); cycle.enabled = true; break;
 *     case IQFOC_RESTART_RUN: break;
 *     default: cycle.enabled = false; break;
 *     }
 *
 * faults: the cycle's status bits that trip, those of iqfoc/supervision.h, the break input. A latch that only
 * clearing resets must not be among them while it waits. Pass the causes that are still present (level of the break
 * line, DC link), and pass the bits of a trip once.
 *
 * All functions share one state: call them from one context, the interrupt or task that calls the step once a cycle.
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
    uint32_t may_restart;   /* bits after which the drive may try again; all other bits latch */
    uint32_t wait_cycles;   /* cycles without a fault before a try: 1 ... 2^31 */
    uint32_t tries;         /* tries in a row; 0: every fault latches */
    uint32_t forget_cycles; /* cycles without a fault after which `tried` returns to 0: 1 ... 2^31 */
} iqfoc_restart_config_t;

typedef enum iqfoc_restart_action {
    IQFOC_RESTART_RUN,    /* nothing wrong */
    IQFOC_RESTART_WAIT,   /* off, a try may follow */
    IQFOC_RESTART_TRY,    /* returned once: clear and continue */
    IQFOC_RESTART_LATCHED /* off until acknowledged */
} iqfoc_restart_action_t;

/* The state. All fields may be read. */
typedef struct iqfoc_restart {
    const iqfoc_restart_config_t *config;
    iqfoc_restart_action_t action; /* the last step's */
    uint32_t faults;               /* all bits since the last acknowledgement */
    uint32_t quiet;                /* cycles without a fault */
    uint32_t tried;                /* tries in a row */
} iqfoc_restart_t;

/* Initialises it as running. config must outlive it. IQFOC_ERROR_RESTART: a field out of its range. */
iqfoc_error_t iqfoc_restart_init(iqfoc_restart_t *restart, const iqfoc_restart_config_t *config);

/* Once a cycle, with the faults of this moment. */
iqfoc_restart_action_t iqfoc_restart_step(iqfoc_restart_t *restart, uint32_t faults);

/*
 * Acknowledges a latched fault: the drive then waits, as after a fault that may be tried again. No effect if it is
 * not latched. The firmware calls it when the operator resets the fault, in the context of the step.
 */
void iqfoc_restart_acknowledge(iqfoc_restart_t *restart);

#ifdef __cplusplus
}
#endif

#endif

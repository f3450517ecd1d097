/* A closed loop of the firmware with the small emulated drive (small_drive.h): one digest of all commands of a run. */
#ifndef TESTS_TARGET_CLOSED_LOOP_H
#define TESTS_TARGET_CLOSED_LOOP_H

#include <stdint.h>

#define CLOSED_LOOP_CYCLES 20000

typedef struct closed_loop_result {
    uint64_t digest;     /* of every command and of the state behind it */
    uint32_t status;     /* the cycle's sticky bits at the end */
    uint32_t limited;    /* cycles in which the voltage was shortened */
    int32_t worst_error; /* largest component of the current error, IQ24, away from steps and limits */
} closed_loop_result_t;

/* CLOSED_LOOP_CYCLES cycles through the HAL of port/emulated, one feedback after the other. */
closed_loop_result_t closed_loop_run(void);

#endif

/*
 * Control with nominal and with diagnosed parameters: the same firmware in the loop with a drive that differs
 * from its motor file, once configured from that file, once from the extended file that `iqfoc diagnose`
 * wrote, with what the library can put right (iqfoc/extension.h).
 */
#ifndef SIM_HOST_LOOPS_EXTENDED_LOOPS_H
#define SIM_HOST_LOOPS_EXTENDED_LOOPS_H

#include "base/json.h"
#include "closed_loop.h"

#include <stdio.h>

enum { EXTENDED_SPEEDS = 3, EXTENDED_BELIEFS = 2 };

typedef enum extended_method {
    EXTENDED_PI,       /* the library's cycle, mid-point sample */
    EXTENDED_DEADBEAT, /* exact predictor */
    EXTENDED_LEARNING, /* the same with a learnt drift */
    EXTENDED_METHODS
} extended_method;

typedef struct extended_loops {
    double rpm[EXTENDED_SPEEDS]; /* shares of the motor's highest speed */
    loop_result at[EXTENDED_SPEEDS][EXTENDED_METHODS][EXTENDED_BELIEFS]; /* nominal, extended */
} extended_loops;

/* belief: the nominal motor, and the extended one. drive: what the drive truly is. */
bool extended_loops_run(const motor *const belief[EXTENDED_BELIEFS], const plant_config *drive,
                        extended_loops *all, error *e);

void extended_loops_print(const extended_loops *all, FILE *stream);
json_t *extended_loops_json(const extended_loops *all);

#endif

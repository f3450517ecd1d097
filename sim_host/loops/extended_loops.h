/*
 * Control with nominal and with diagnosed parameters. The drive differs from its motor file. The same firmware is
 * configured from that file, and from the extended file of `iqfoc diagnose` with the library's corrections
 * (iqfoc/extension.h).
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
    EXTENDED_LEARNING, /* the same with a disturbance observer */
    EXTENDED_METHODS
} extended_method;

typedef struct extended_loops {
    double rpm[EXTENDED_SPEEDS]; /* shares of the motor's highest speed */
    loop_result at[EXTENDED_SPEEDS][EXTENDED_METHODS][EXTENDED_BELIEFS]; /* nominal, extended */
} extended_loops;

/* belief: the nominal motor, and the extended one. drive: the true drive. */
bool extended_loops_run(const motor *const belief[EXTENDED_BELIEFS], const plant_config *drive,
                        extended_loops *all, error *e);

void extended_loops_print(const extended_loops *all, FILE *stream);
json_t *extended_loops_json(const extended_loops *all);

#endif

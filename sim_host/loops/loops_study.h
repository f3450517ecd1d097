/* Everything that `iqfoc loops` computes, and its output: tables, JSON, report page. */
#ifndef SIM_HOST_LOOPS_LOOPS_STUDY_H
#define SIM_HOST_LOOPS_LOOPS_STUDY_H

#include "base/json.h"
#include "corrected_loops.h"
#include "finite_set_loops.h"
#include "run_up.h"
#include "sensorless_loops.h"
#include "six_step_loop.h"
#include "update_loops.h"

#include <stdio.h>

enum { SIX_STEP_DISCRETE, SIX_STEP_CORRECTED, SIX_STEP_LOOPS };

typedef struct loops_study {
    six_step_loop six_step[SIX_STEP_LOOPS];
    current_loops current;
    finite_set_loops finite_set;
    run_up run_ups[RUN_UP_CASES];
    update_loops updates;
    corrected_loops corrected;
    sensorless_loops sensorless;
} loops_study;

extern const char *const six_step_loop_text[SIX_STEP_LOOPS];

bool loops_study_run(loops_study *s, error *e);

void loops_study_print(const loops_study *s, FILE *stream);

/* NULL when memory runs out. Values that a tripped loop does not have are null. */
json_t *loops_study_json(const loops_study *s);

bool loops_study_page(const loops_study *s, const char *directory, error *e);

#endif

/* `iqfoc loops --pulse-modes`: two drives from standstill through all pulse modes and back at rated torque; their text, JSON and page. */
#ifndef SIM_HOST_LOOPS_PULSE_RUN_UPS_H
#define SIM_HOST_LOOPS_PULSE_RUN_UPS_H

#include "pulse_run_up.h"

#include "base/json.h"

#include <stdio.h>

typedef struct pulse_run_ups {
    pulse_drive drive[PULSE_DRIVES];
    pulse_run_up of[PULSE_DRIVES];
} pulse_run_ups;

/* The run of each drive. */
extern const pulse_case pulse_run_ups_case;

bool pulse_run_ups_run(pulse_run_ups *all, error *e);

void pulse_run_ups_print(const pulse_run_ups *all, FILE *f);

/* NULL when memory runs out. */
json_t *pulse_run_ups_json(const pulse_run_ups *all);

/* DIRECTORY/index.html. */
bool pulse_run_ups_page(const pulse_run_ups *all, const char *directory, error *e);

#endif

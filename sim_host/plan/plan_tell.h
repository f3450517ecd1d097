/*
 * Output of a plan: the scenario file, the firmware's header, JSON and text.
 */
#ifndef SIM_HOST_PLAN_PLAN_TELL_H
#define SIM_HOST_PLAN_PLAN_TELL_H

#include "plan.h"

#include "base/json.h"
#include <stdio.h>

/* A plan, and a scenario of the same time to compare with. */
typedef struct plan_report {
    const motor *motor;
    plan_limits limits;
    plan plan;
    const char *against_path; /* NULL: none */
    double against_seconds;
    plan_outlook against;
} plan_report;

/* The recording as a scenario of docs/scenario.md. */
bool plan_write_scenario(const plan_report *r, const char *path, error *e);

/* The same for a firmware: examples/planned_recording/planned.h. */
bool plan_write_header(const plan_report *r, const char *path, error *e);

/* NULL: out of memory. */
json_t *plan_json(const plan_report *r);

void plan_print(const plan_report *r, FILE *out);

#endif

/* Output of the run-ups: text, JSON, and a part of the report page. */
#ifndef SIM_HOST_LOOPS_RUN_UP_SHOW_H
#define SIM_HOST_LOOPS_RUN_UP_SHOW_H

#include "run_up.h"

#include "base/json.h"
#include "report/page.h"

#include <stdio.h>

void run_ups_print(const run_up all[RUN_UP_CASES], FILE *f);

/* A list, or NULL when memory runs out. */
json_t *run_ups_json(const run_up all[RUN_UP_CASES]);

bool run_ups_part(page *p, const run_up all[RUN_UP_CASES], error *e);

#endif

/*
 * The study of PI control with the corrected mean (2016 (10)) as feedback: the highest stable bandwidth over the
 * SFFR, and the loop in the plant at the default bandwidth and at 80 % of the highest. Drive and step as in
 * current_loops.h.
 */
#ifndef SIM_HOST_LOOPS_CORRECTED_LOOPS_H
#define SIM_HOST_LOOPS_CORRECTED_LOOPS_H

#include "current_loops.h"

#include "base/json.h"
#include "report/page.h"

#include <stdio.h>

enum { CORRECTED_RATIOS = 9 };
extern const double corrected_ratios[CORRECTED_RATIOS];

typedef struct corrected_loops {
    double most_Hz[CORRECTED_RATIOS]; /* highest stable bandwidth by the linear loop; 0: none */
    loop_result usual[CORRECTED_RATIOS];
    loop_result below[CORRECTED_RATIOS]; /* at 80 % of most_Hz; the default's result if that is 0 */
} corrected_loops;

/* One loop in the plant; bandwidth_Hz 0: the default. */
bool corrected_loop_run(double ratio, double bandwidth_Hz, loop_result *result, error *e);

bool corrected_loops_run(corrected_loops *all, error *e);

void corrected_loops_print(const corrected_loops *all, FILE *f);
/* NULL when memory runs out. */
json_t *corrected_loops_json(const corrected_loops *all);
void corrected_loops_part(page *p, const corrected_loops *all);

#endif

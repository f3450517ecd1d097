/*
 * The study of one and two updates per carrier period, at low SFFR and with the same switching, with the drive and
 * the step of current_loops.h. With two, valley and peak both start a control cycle of half the length. Samples there
 * are as free of ripple. The delay and the angle of a cycle are halved.
 */
#ifndef SIM_HOST_LOOPS_UPDATE_LOOPS_H
#define SIM_HOST_LOOPS_UPDATE_LOOPS_H

#include "current_loops.h"

#include "base/json.h"
#include "report/page.h"

#include <stdio.h>

enum { UPDATE_RATIOS = 5, UPDATE_METHODS = 3, UPDATES = 2 };

extern const double update_ratios[UPDATE_RATIOS]; /* of the carrier to the fundamental */
extern const loop_method update_methods[UPDATE_METHODS];

typedef struct update_loops {
    loop_result at[UPDATE_RATIOS][UPDATE_METHODS][UPDATES]; /* one update, two */
} update_loops;

bool update_loop_run(double ratio, loop_method how, bool twice, loop_result *result, error *e);

bool update_loops_run(update_loops *all, error *e);

void update_loops_print(const update_loops *all, FILE *f);
json_t *update_loops_json(const update_loops *all);
void update_loops_part(page *p, const update_loops *all);

#endif

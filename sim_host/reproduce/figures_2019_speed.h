/* 2019: Figs. 7 and 9, errors over the ratio of switching to fundamental frequency. */
#ifndef SIM_HOST_REPRODUCE_FIGURES_2019_SPEED_H
#define SIM_HOST_REPRODUCE_FIGURES_2019_SPEED_H

#include "../report/page.h"
#include "method_errors.h"
#include "rows.h"

bool figure_2019_7(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e);
bool figure_2019_9(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e);

#endif

/*
 * The first screen of a report page: verdict, errors as bars, the figure that proves the cause, next steps.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_FIRST_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_FIRST_H

#include "figures.h"

typedef bool (*figure)(page *p, const report_context *c, error *e);

/*
 * The figure of the first screen: the proof of the strongest cause; without a cause, the pattern of the residual; of a
 * clean recording, the residual against the current.
 */
figure report_first_figure(const report_context *c);

/* False with *e set if memory runs out. */
bool report_first(page *p, const report_context *c, error *e);

#endif

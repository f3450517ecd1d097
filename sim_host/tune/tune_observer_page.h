/* The observer's part of a design's page. */
#ifndef SIM_HOST_TUNE_TUNE_OBSERVER_PAGE_H
#define SIM_HOST_TUNE_TUNE_OBSERVER_PAGE_H

#include "tune_report.h"

#include "report/page.h"

/* Margins, angle error and noise over the speed, bandwidths to choose from, and the trial. */
bool tune_observer_part(page *p, const tune_report *t, error *e);

#endif

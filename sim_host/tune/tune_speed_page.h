/* The speed control's part of a design's page. */
#ifndef SIM_HOST_TUNE_TUNE_SPEED_PAGE_H
#define SIM_HOST_TUNE_TUNE_SPEED_PAGE_H

#include "tune_report.h"

#include "report/page.h"

/* Run-up, load and step of the set-point in the plant, for three shafts. Nothing if no inertia was stated. */
bool tune_speed_part(page *p, const tune_report *t, error *e);

#endif

/*
 * The explanations of a report page: next steps, next recording, motor values, glossary.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_WORDS_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_WORDS_H

#include "diagnose/result.h"
#include "firmware_map.h"
#include "report/page.h"

/* One step for each cause, by the correction that the firmware has for it; then the next recording. */
void report_next(page *p, const diagnosis *d, const firmware_map *map);
/* The candidates of the next recording with the uncertainty each would reach; nothing if none was computed. */
void report_experiment(page *p, const diagnosis *d);
/* The values of the motor file and of the extended file. */
void report_motor(page *p, const motor *nominal, const diagnosis *d);
void report_glossary(page *p);

#endif

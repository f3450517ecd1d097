/*
 * The tables of a report page: causes, estimates, errors, runs, forward validation.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_TABLES_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_TABLES_H

#include "diagnose/result.h"
#include "firmware_gain.h"
#include "forward_validation.h"
#include "report/page.h"

void report_causes(page *p, const diagnosis *d);
/* R, L_d, L_q, psi_f, dead time and voltage delay, named as a cause or not. */
void report_estimates(page *p, const diagnosis *d);
void report_errors(page *p, const diagnosis *d, const firmware_gain *firmware);
void report_learned(page *p, const diagnosis *d);
void report_runs(page *p, const diagnosis *d, const forward_validation *validation);
void report_plant(page *p, const diagnosis *d, const forward_validation *validation);

#endif

/*
 * The tables and sentences of a diagnosis' page.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_TABLES_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_TABLES_H

#include "diagnose/result.h"
#include "firmware_gain.h"
#include "plant_witness.h"
#include "report/page.h"

/* One sentence: what is wrong, how sure, what it gains. */
void report_lead(page *p, const diagnosis *d);

void report_causes(page *p, const diagnosis *d);
/* R, L_d, L_q, psi_f, dead time and delay, named or not. */
void report_estimates(page *p, const diagnosis *d);
void report_errors(page *p, const diagnosis *d, const firmware_gain *firmware);
void report_learned(page *p, const diagnosis *d);
void report_hypotheses(page *p, const diagnosis *d);
void report_runs(page *p, const diagnosis *d, const plant_witness *witness);
void report_plant(page *p, const diagnosis *d, const plant_witness *witness);

#endif

/*
 * A named cause in the parameters and units of interfaces.md, with 95 % intervals.
 */
#ifndef SIM_HOST_DIAGNOSE_CAUSE_REPORT_H
#define SIM_HOST_DIAGNOSE_CAUSE_REPORT_H

#include "certainty.h"
#include "diagnose_result.h"

void cause_report(diagnosis_cause *cause, hypothesis_id h, const fit_data *d, const fit_state *s,
                  const certainty *c);

/* The knee of the plain law sat(i / knee) that loses, over currents up to the rated peak, most nearly what
 * the fitted law loses. */
double cause_plain_knee_A(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A);

#endif

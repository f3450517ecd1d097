/*
 * The hypotheses that a diagnosis compared, strongest first, each with the reason why it was named or not.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_HYPOTHESES_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_HYPOTHESES_H

#include "diagnose/result.h"
#include "report/page.h"

/* Ten rows; the others open on request. */
void report_hypotheses(page *p, const diagnosis *d);

#endif

/*
 * What a diagnosis' page says to someone who has not read the documents: what to do next, what its words and causes
 * mean, which values the motor has.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_REPORT_WORDS_H
#define SIM_HOST_DIAGNOSE_SHOW_REPORT_WORDS_H

#include "diagnose/result.h"
#include "report/page.h"

/* By verdict and by what the firmware has against each cause; then the next experiment. */
void report_next(page *p, const diagnosis *d);
/* What the computed experiment would tell, beside others; nothing where none was computed. */
void report_experiment(page *p, const diagnosis *d);
/* The motor file's values beside the extended file's. */
void report_motor(page *p, const motor *nominal, const diagnosis *d);
void report_glossary(page *p);

#endif

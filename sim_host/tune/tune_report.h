/* A design with its trial and comparison, as text, JSON, page and firmware's header. */
#ifndef SIM_HOST_TUNE_TUNE_REPORT_H
#define SIM_HOST_TUNE_TUNE_REPORT_H

#include "base/json.h"
#include "tune_trial.h"

#include <stdio.h>

typedef struct tune_report {
    tune_result result;
    tune_trial trial;
    tune_comparison comparison;
    const char *diagnosis_path; /* NULL: none */
} tune_report;

void tune_report_print(const tune_report *t, FILE *stream);

/* NULL when memory runs out. */
json_t *tune_report_json(const tune_report *t);

bool tune_report_page(const tune_report *t, const char *directory, error *e);

/* DIRECTORY/iqfoc_tuned.h: the law of iqfoc/tuned_control.h in constants. */
bool tune_report_header(const tune_report *t, const char *directory, error *e);

#endif

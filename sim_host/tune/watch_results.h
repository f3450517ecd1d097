/* Results of the trials of change detector and adaptation, as JSON and as text. */
#ifndef SIM_HOST_TUNE_WATCH_RESULTS_H
#define SIM_HOST_TUNE_WATCH_RESULTS_H

#include "adapt_trial.h"
#include "base/json.h"
#include "watch_angle_trial.h"
#include "watch_trial.h"

#include <stdio.h>

/* Winding and magnet warm in the first time, out of the second. */
#define WATCH_WARMING_S 12.0
#define WATCH_ADAPTED_S 16.0

typedef struct watch_results {
    bool tried; /* else only the runs without a change are valid */
    watch_trial of[WATCH_CHANGES];
    double fall; /* of L by the motor file's saturation, as the detector has it */
    bool ran[WATCH_CONDITIONS];
    watch_clean clean[WATCH_CONDITIONS];
    adapt_trial plain, adapted;
    watch_angle_trial angle[WATCH_ANGLE_FAULTS];
} watch_results;

/* A new reference; NULL: out of memory. */
json_t *watch_results_json(const motor *m, const watch_results *r);

void watch_results_print(const motor *m, const watch_results *r, FILE *out);

#endif

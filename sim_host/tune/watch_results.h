/* What the trials of the watch and of the adaptation came to, as JSON and as text. */
#ifndef SIM_HOST_TUNE_WATCH_RESULTS_H
#define SIM_HOST_TUNE_WATCH_RESULTS_H

#include "adapt_trial.h"
#include "base/json.h"
#include "watch_trial.h"

#include <stdio.h>

/* A winding and a magnet that warm in the first, of the second. */
#define WATCH_WARMING_S 12.0
#define WATCH_ADAPTED_S 16.0

typedef struct watch_results {
    bool tried; /* else there is nothing but `clean` */
    watch_trial of[WATCH_CHANGES];
    watch_clean clean;
    adapt_trial plain, adapted;
} watch_results;

/* A new reference; NULL: out of memory. */
json_t *watch_results_json(const motor *m, const watch_results *r);

void watch_results_print(const motor *m, const watch_results *r, FILE *out);

#endif

/*
 * The diagnosis: from a recording and a motor file to what the model gets wrong, why, and what mending it
 * gains.
 *
 * In order: check that the recording can be used (plausible.h), cut it into fitted and held-out blocks
 * (rows.h), find the set of causes (search.h), keep those that are certain (certainty.h), and measure on the
 * held-out blocks (measure.h).
 */
#ifndef SIM_HOST_DIAGNOSE_DIAGNOSE_H
#define SIM_HOST_DIAGNOSE_DIAGNOSE_H

#include "../base/error.h"
#include "diagnose_result.h"
#include "hypotheses.h"

#include <stdio.h>

typedef struct diagnose_options {
    hypothesis_set skip; /* hypotheses that are left out */
    FILE *trace;         /* where to tell how the search went, or NULL */
    bool series;         /* fill the series (the report needs them) */
} diagnose_options;

/* `recording_path` is for messages. On failure *e is set and nothing needs to be freed. */
bool diagnose(diagnosis *d, const recording *rec, const char *recording_path, const motor *m,
              const diagnose_options *options, error *e);

#endif

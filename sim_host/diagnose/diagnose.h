/*
 * The diagnosis: finds the causes of the model error in a recording, and the extended model. Its steps, a folder each: check that the
 * recording is usable; identify the parameters of a set of hypotheses on fitted blocks; measure errors on held-out blocks; choose the set
 * of causes; tell the result. show/ makes the report page, the firmware header and the forward validation from the result.
 */
#ifndef SIM_HOST_DIAGNOSE_DIAGNOSE_H
#define SIM_HOST_DIAGNOSE_DIAGNOSE_H

#include "base/error.h"
#include "diagnose/identify/hypotheses.h"
#include "diagnose/weigh/teller.h"
#include "result.h"

typedef struct diagnose_options {
    hypothesis_set skip;    /* hypotheses that are left out */
    diagnose_teller teller; /* trace and progress of the search; zeros: none */
    bool any_size;          /* name every certain cause, also below its reporting threshold (`least`) */
    bool series;            /* fill the series (the report needs them) */
} diagnose_options;

/* On failure *e is set and nothing needs to be freed. */
bool diagnose(diagnosis *d, const recording *rec, const motor *m, const diagnose_options *options, error *e);

#endif

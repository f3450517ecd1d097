/*
 * The diagnosis: from a recording and a motor file to what the model gets wrong, why, and what mending it
 * gains.
 *
 * In order, each a folder: check that the recording can be used; identify, on fitted blocks, what a set of
 * hypotheses would move; measure errors on held-out ones; choose the set of causes; tell what was found. What is
 * shown beside it (pictures, the firmware's header, the plant as a witness) is made of the result (show/).
 */
#ifndef SIM_HOST_DIAGNOSE_DIAGNOSE_H
#define SIM_HOST_DIAGNOSE_DIAGNOSE_H

#include "base/error.h"
#include "diagnose/choose/teller.h"
#include "diagnose/identify/hypotheses.h"
#include "result.h"

typedef struct diagnose_options {
    hypothesis_set skip;    /* hypotheses that are left out */
    diagnose_teller teller; /* of the search; zeros: nobody is told */
    bool any_size;          /* name what is certain however small it is, below each hypothesis' `least` too */
    bool series;            /* fill the series (the report needs them) */
} diagnose_options;

/* On failure *e is set and nothing needs to be freed. */
bool diagnose(diagnosis *d, const recording *rec, const motor *m, const diagnose_options *options, error *e);

#endif

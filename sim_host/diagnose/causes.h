/*
 * The causes of one recording: found, weighed until all that stay deserve their name, and put in order.
 */
#ifndef SIM_HOST_DIAGNOSE_CAUSES_H
#define SIM_HOST_DIAGNOSE_CAUSES_H

#include "certainty.h"
#include "diagnose_result.h"

#include <stdio.h>

/* The verdict's tolerance over the noise floor, as interfaces.md defines it. */
#define CAUSES_FLOOR_TOLERANCE 1.25

/* What one diagnosis works on. */
typedef struct session {
    diagnose_rows rows;
    parameter_set parameters;
    fit_data fitted;
    fit_state state;
    fit_state nominal;
    certainty certainty;
    hypothesis_set possible;
} session;

/* Searches from w->nominal and drops what is not certain, or too small a part, until all that stays is.
 * Leaves the fit in w->state. False: out of memory. */
bool causes_find(session *w, FILE *trace);

/*
 * The causes in the order of what each takes off the held-out error, with their gains and intervals, into
 * d->cause; `member` likewise. Then the extended drive and motor, which hold what was named and nothing else.
 * Needs d->nominal, and d->extended_motor set to the motor file.
 */
void causes_order(session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES]);

#endif

/*
 * What is known of the machine whether a cause was named or not: estimates, and one covariance of the machine's
 * parameters and the causes'.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_KNOWN_H
#define SIM_HOST_DIAGNOSE_TELL_KNOWN_H

#include "diagnose/choose/evidence.h"
#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/* The numbers that are estimated, in the order of d->estimate. */
typedef struct known_number {
    const char *name, *unit;
    coordinate_id coordinate;
    const char *told[2]; /* the names under which a cause may tell it */
} known_number;

extern const known_number known_numbers[DIAGNOSIS_ESTIMATES];

/* Fills d->estimate and d->covariance; d->cause is there. The view is one at w->state. */
void known_tell(const session *w, const evidence_view *view, diagnosis *d);

#endif

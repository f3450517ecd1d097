/*
 * Estimates of R, L_d, L_q, psi_f, dead time and voltage delay, named as a cause or not, and one covariance of these and the
 * causes' parameters.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_KNOWN_H
#define SIM_HOST_DIAGNOSE_TELL_KNOWN_H

#include "diagnose/result.h"
#include "diagnose/session.h"
#include "diagnose/weigh/evidence.h"

/* The estimated numbers, in the order of d->estimate. */
typedef struct known_number {
    const char *name, *unit;
    coordinate_id coordinate;
    const char *parameter[2]; /* the names that a cause has for it */
} known_number;

extern const known_number known_numbers[DIAGNOSIS_ESTIMATES];

/* Fills d->estimate and d->covariance; d->cause is there. The view is one at w->state. */
void known_tell(const session *w, const evidence_view *view, diagnosis *d);

/* Widens the estimates to hold those of another state that explains the recording as well. */
void known_reach(const session *other, diagnosis *d);

/* Where the model is incomplete its errors are no noise: estimates are as much less certain as it errs beyond the noise. */
void known_widen(diagnosis *d);

#endif

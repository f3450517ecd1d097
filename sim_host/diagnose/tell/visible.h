/*
 * What the recording does not show: directions of R, L_d, L_q and psi_f in which it says hardly more than is usual of drives
 * anyhow, and the causes that it cannot tell apart where it errs by more than noise.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_VISIBLE_H
#define SIM_HOST_DIAGNOSE_TELL_VISIBLE_H

#include "diagnose/result.h"
#include "diagnose/session.h"
#include "diagnose/weigh/evidence.h"

/*
 * Fills d->explanation: each set of causes that, with the named ones, explains about as much as the best of them, and needs all its
 * members. If an undecided member depends on the factor of R, L, psi_f and all voltages, they are the sets at other factors
 * (d->alike_by_scale). Widens the intervals of causes and minor effects to hold their values in each. The view is one at w->state.
 */
void explanations_tell(const session *w, const evidence_view *view, hypothesis_set named, diagnosis *d);

/*
 * Fills d->not_visible, and takes a verdict `clean` back to `unexplained` where the error is above the noise and lies along a direction
 * that the recording does not show: then it fills d->explanation too. A verdict with undecided causes is `partly` or `unexplained`. The
 * view is one at w->state.
 */
void visible_tell(const session *w, const evidence_view *view, diagnosis *d);

#endif

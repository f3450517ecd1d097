/*
 * The next recording: the test segment that would determine most of the open numbers, by the extended model. Open is a pair of causes
 * that is not distinguishable, or numbers that are not excited. The information matrix of each segment is added to that of this
 * recording. The inverse gives the numbers' intervals, a pair's correlation r, and the chi square that separates the pair; all other
 * parameters are free within their tolerance. Segments are ranked by log(variance), summed over the open numbers; for a pair by -2
 * log(chi square); and by -10 log(1 - r^2), as in a plan (plan/plan.h).
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_EXPERIMENT_H
#define SIM_HOST_DIAGNOSE_NEXT_EXPERIMENT_H

#include "diagnose/result.h"
#include "diagnose/session.h"
#include "diagnose/weigh/evidence.h"

/*
 * Fills d->experiment if something is open. d has its causes with confused_with, and the estimates; `member` lists the causes'
 * hypotheses. The view is one at w->state of all that is possible.
 */
void experiment_find(const session *w, const evidence_view *view, const hypothesis_id *member, diagnosis *d);

/* The same about a member of w->state and another of d->explanation. */
void experiment_of_explanations(const session *w, const evidence_view *view, hypothesis_set undecided,
                                diagnosis *d);

#endif

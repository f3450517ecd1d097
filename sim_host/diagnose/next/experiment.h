/*
 * The next experiment: of all pieces that a recording could be made of, the one that would tell most of what this
 * one leaves open, by the model that was found.
 *
 * What is open is a named cause with what it is confused with, or the numbers that are not excited. To the
 * information of this recording that of a piece is added, for each piece, and the numbers' intervals, a pair's
 * correlation r and the chi square by which one of a pair would lose the other's place are read off the inverse, all
 * else free within its last digits. Ranked are the pieces by log(variance), summed over what is asked, which of a pair
 * is -2 log(chi square), and by -10 log(1 - r^2), as a plan's are (plan/plan.h): intervals shrink with the time, a
 * correlation does not.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_EXPERIMENT_H
#define SIM_HOST_DIAGNOSE_NEXT_EXPERIMENT_H

#include "diagnose/choose/evidence.h"
#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/*
 * Fills d->experiment where something is open. d's causes are there, with what they are confused with, and the
 * estimates; `member` lists the causes' hypotheses. The view is one at w->state of all that is possible.
 */
void experiment_find(const session *w, const evidence_view *view, const hypothesis_id *member, diagnosis *d);

#endif

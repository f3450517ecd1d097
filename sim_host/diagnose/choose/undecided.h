/*
 * Which fitted members are no causes, because the recording does not decide between them and others. They stay in the model as minor
 * effects, and are candidates (docs/diagnosis.md).
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H
#define SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H

#include "diagnose/session.h"

/* A cause is named if its probability among all sets near the state that the search found is at least this. */
#define UNDECIDED_NAMED 0.95
/* At the end of all fits, and in a fit of likely effects, which is no search. */
#define UNDECIDED_LIKELY 0.5

/*
 * Makes the named members minor effects whose probability among all sets near the state is below the limit, and all of them if that of
 * the catalogue (w->borne_out) is below 0.95. It is the probability as printed, but for that of the catalogue, if w->fitted.searches is
 * false. w->undecided gets these members in addition. False: out of memory.
 */
bool undecided_accuse_none(session *w, double limit);

#endif

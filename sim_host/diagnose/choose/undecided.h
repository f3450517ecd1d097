/*
 * Which fitted members are no causes, because the recording does not decide between them and others. They stay in the model as minor
 * effects, and are candidates (docs/diagnosis.md).
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H
#define SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H

#include "session.h"

#include <stdio.h>

/*
 * Makes the named members minor effects whose probability is below 0.95 (0.5 in a fit of `likely` effects), and all of them if that of
 * the catalogue (w->borne_out) is below 0.95, at the end of all fits. It is the probability among all sets near the state, as printed but
 * for that of the catalogue, if w->fitted.searches is false. w->undecided gets these members. False: out of memory.
 */
bool undecided_accuse_none(session *w, bool likely, FILE *trace);

#endif

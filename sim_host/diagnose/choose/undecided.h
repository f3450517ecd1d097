/*
 * Takes out causes that the recording cannot separate from others. They become candidates (docs/diagnosis.md) instead of named
 * causes.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H
#define SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H

#include "session.h"
#include "teller.h"

/*
 * Takes out the named members whose probability is below 0.95, all of them, and fits the others again. Minor effects stay. A member
 * whose rival makes the same drive (evidence_is_same_drive) becomes a minor effect instead.
 * If the others alone do not reduce the error of held-out rows, they are taken out as well.
 * w->undecided gets the members that were taken out, and w->open the state before. False: out of memory.
 */
bool undecided_take_out(session *w, const diagnose_teller *teller);

/*
 * Makes the named members whose probability is below one half minor effects, and all of them if that of the catalogue (w->borne_out) is
 * below 0.95, at the end of all fits: they stay in the model, and are no causes. It is the probability among all sets near the state, as
 * printed but for that of the catalogue, if w->fitted.searches is false. w->undecided gets the members. False: out of memory.
 */
bool undecided_accuse_none(session *w, FILE *trace);

#endif

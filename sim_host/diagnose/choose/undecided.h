/*
 * Causes that the recording cannot tell from others.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H
#define SIM_HOST_DIAGNOSE_CHOOSE_UNDECIDED_H

#include "session.h"
#include "teller.h"

/*
 * Takes out the named members whose probability is below 0.99, the least probable first, and fits the others again each time. Notes them
 * in w->undecided, and the state with them in w->open. False: out of memory.
 */
bool undecided_take_out(session *w, const diagnose_teller *teller);

#endif

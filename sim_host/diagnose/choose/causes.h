/*
 * The causes of one recording: found, and weighed until all that stay deserve their name.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_CAUSES_H
#define SIM_HOST_DIAGNOSE_CHOOSE_CAUSES_H

#include "session.h"
#include "teller.h"

/* Searches from w->nominal and drops what is not certain, or too small a part, until all that stays is.
 * Leaves the fit in w->state. False: out of memory. */
bool causes_find(session *w, const diagnose_teller *teller);

#endif

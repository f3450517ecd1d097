/*
 * The next experiment: one or two sentences on what would separate what is confused, or show what is unexplained.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_ADVICE_H
#define SIM_HOST_DIAGNOSE_TELL_ADVICE_H

#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/* Sets d->next_experiment. Needs d's causes with what they are confused with, its verdict, structure and experiment. */
void advice_tell(const session *w, diagnosis *d);

#endif

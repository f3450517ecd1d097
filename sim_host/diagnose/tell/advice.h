/*
 * The next recording in one or two sentences: it separates causes that this recording cannot distinguish, or shows the cause of
 * an unexplained residual.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_ADVICE_H
#define SIM_HOST_DIAGNOSE_TELL_ADVICE_H

#include "diagnose/result.h"
#include "diagnose/session.h"

/* Sets d->next_experiment. Needs d's causes with `confused_with`, verdict, structure and experiment. */
void advice_tell(const session *w, diagnosis *d);

#endif

/*
 * The verdict in one sentence: causes, model error before and after, noise floor. Terminal, JSON, report and header use it.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_SENTENCE_H
#define SIM_HOST_DIAGNOSE_TELL_SENTENCE_H

#include "diagnose/result.h"

/* Sets d->sentence. Needs d's causes, verdict and errors. */
void sentence_tell(diagnosis *d);

#endif

/*
 * The named causes in the order of what each takes off the held-out error, and the model that holds them.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_NAMED_H
#define SIM_HOST_DIAGNOSE_TELL_NAMED_H

#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/*
 * Fills d->cause with values, intervals and gains, and `member` likewise. Then the extended drive and motor,
 * which hold what was named and nothing else. Needs d->nominal, and d->extended_motor set to the motor file.
 */
void named_tell(const session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES]);

#endif

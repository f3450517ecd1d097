/*
 * The named causes, ordered by how much each reduces the held-out error, and the extended model.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_NAMED_H
#define SIM_HOST_DIAGNOSE_TELL_NAMED_H

#include "diagnose/result.h"
#include "diagnose/session.h"

/*
 * Fills d->cause with values, intervals and gains, and `member` likewise. Then the extended drive and motor
 * with the named causes only. Needs d->nominal, and d->extended_motor set to the motor file.
 */
void named_tell(const session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES]);

#endif

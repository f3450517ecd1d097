/*
 * A named cause in the parameters and units of interfaces.md, with 95 % intervals: the rows of data/causes.def,
 * read off the motor file that would say what was fitted.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_VALUES_H
#define SIM_HOST_DIAGNOSE_TELL_VALUES_H

#include "diagnose/choose/session.h"
#include "diagnose/result.h"

void values_tell(const session *w, hypothesis_id h, diagnosis_cause *cause);

#endif

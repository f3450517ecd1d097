/*
 * A named cause in the parameters and units of interfaces.md, with 95 % intervals: the rows of data/causes.def,
 * read off the motor file that would say what was fitted.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_VALUES_H
#define SIM_HOST_DIAGNOSE_TELL_VALUES_H

#include "diagnose/choose/session.h"
#include "diagnose/result.h"

/* Values and intervals of a cause; and what the fit says of a parameter at its z moved along a column. */
double values_at(const session *w, const motor_value *v, int column, double by);
void values_tell(const session *w, hypothesis_id h, diagnosis_cause *cause);

#endif

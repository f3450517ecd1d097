/*
 * The parameters of a named cause with 95 % intervals, in the names and units of docs/interfaces.md. They are read from the
 * motor file that describes the fit.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_VALUES_H
#define SIM_HOST_DIAGNOSE_TELL_VALUES_H

#include "diagnose/result.h"
#include "diagnose/session.h"

/* A parameter of the fit, moved by `by` along a column. */
double values_at(const session *w, const motor_value *v, int column, double by);
/* All values of a cause in the model at z, with the intervals of the fit about them. */
void values_tell(const session *w, hypothesis_id h, const double z[P_COUNT], diagnosis_cause *cause);

/*
 * The interval of a saturation current; a value of 0 means no saturation. Without saturation the current lies beyond all
 * others: the interval goes up to never_A, a current that no drive reaches. A value of 0 lies at its lower end.
 */
void values_bound_saturation(double never_A, diagnosis_parameter *p);

#endif

/*
 * Three measured currents sum to nought in a machine with a floating star point. What their sum does instead tells,
 * without any model of the motor, which column is not what it says: one that is negated, scaled by a wrong unit or
 * dead.
 *
 * A column x that shows g times its current is known by y + z = -x / g: the other two tell g. A sensor gain that is
 * merely wrong is a cause for the diagnosis to name, and is left to it.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_CURRENT_SUM_H
#define SIM_HOST_DIAGNOSE_CHECK_CURRENT_SUM_H

#include "data/recording.h"

/* False with one line in *e that names the phase. With two sensors only a dead one can be found. */
bool check_current_sum(const recording *rec, error *e);

#endif

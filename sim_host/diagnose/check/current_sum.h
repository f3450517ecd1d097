/*
 * Checks that three measured currents sum to zero, as a floating star point requires. The sum shows, without a motor model, which column
 * is negated, scaled by a wrong unit, or dead. If column x shows g times its current, y + z = -x / g gives g. A moderate gain error is a
 * cause, current_gain, and is left to the diagnosis.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_CURRENT_SUM_H
#define SIM_HOST_DIAGNOSE_CHECK_CURRENT_SUM_H

#include "data/recording.h"

/* False with one line in *e that names the phase. With two sensors only a dead one can be found. */
bool check_current_sum(const recording *rec, error *e);

#endif

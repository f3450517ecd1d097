/*
 * Whether a recording can be diagnosed at all, as it shows before any model is fitted: too short, nothing
 * flows, units, angle against speed. What is wrong is said in words that lead to the cable or the column.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_COLUMNS_H
#define SIM_HOST_DIAGNOSE_CHECK_COLUMNS_H

#include "data/motor.h"
#include "data/recording.h"

/* False with one line in *e. */
bool check_columns(const recording *rec, const motor *m, error *e);

#endif

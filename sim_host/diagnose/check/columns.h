/*
 * Checks that a recording is usable before any model is fitted: length, cycle time, currents, units, angle and speed. Messages name the
 * column or the cable to check.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_COLUMNS_H
#define SIM_HOST_DIAGNOSE_CHECK_COLUMNS_H

#include "data/motor.h"
#include "data/recording.h"

/* False with one line in *e. */
bool check_columns(const recording *rec, const motor *m, error *e);

#endif

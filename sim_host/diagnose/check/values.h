/*
 * Values that are finite, and may be what a drive has, but not in this recording: a DC link of 0 V, or of a hundred
 * times the usual, in a row that is believed; duties that are percent or compare counts.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_VALUES_H
#define SIM_HOST_DIAGNOSE_CHECK_VALUES_H

#include "data/recording.h"

/* False with one line in *e that names the column, and the line of the file if it is a single row. */
bool check_values(const recording *rec, error *e);

/* The same for a speed at which the angle of the next cycle says nothing; after its unit has been checked. */
bool check_speed(const recording *rec, error *e);

#endif

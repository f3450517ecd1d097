/*
 * Checks for values that no drive has in a usable recording: a DC link of 0 V or of ten times its median, duties in percent or compare
 * counts, a speed above half an electrical period per cycle.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_VALUES_H
#define SIM_HOST_DIAGNOSE_CHECK_VALUES_H

#include "data/recording.h"

/* False with one line in *e that names the column, and the line of the file if it is a single row. */
bool check_values(const recording *rec, error *e);

/* The same for a speed above half an electrical period per control cycle; its unit is checked before. */
bool check_speed(const recording *rec, error *e);

#endif

/*
 * Whether a recording can be diagnosed at all, and if not, what is wrong with it in words that lead to the
 * cable or the column.
 */
#ifndef SIM_HOST_DIAGNOSE_PLAUSIBLE_H
#define SIM_HOST_DIAGNOSE_PLAUSIBLE_H

#include "../base/error.h"
#include "../data/motor.h"
#include "../data/recording.h"

/* False with one line in *e: too short, no excitation, swapped phases, signs or direction, units, another
 * motor. */
bool plausible_check(const recording *rec, const char *path, const motor *m, error *e);

#endif

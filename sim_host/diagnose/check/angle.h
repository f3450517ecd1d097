/*
 * Checks angle and speed against each other: degrees, turns, rpm, mechanical instead of electrical, opposite signs.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_ANGLE_H
#define SIM_HOST_DIAGNOSE_CHECK_ANGLE_H

#include "data/motor.h"
#include "data/recording.h"

/* False with one line in *e. */
bool check_angle(const recording *rec, const motor *m, error *e);

#endif

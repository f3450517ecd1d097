/*
 * A speed column that is filtered or late against the angle (model/late_speed.h): the columns tell it by themselves, and the
 * rows' speeds are put right. An angle that is read late by part of a cycle looks the same, so that no less than a cycle and a
 * half has the name.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_SPEED_LAG_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_SPEED_LAG_H

#include "rows.h"

/* Mends the rows of what the motor file knows or, where `search`, the columns tell. False: out of memory. */
bool speed_lag_mend(diagnose_rows *r, const motor *file, bool search);

#endif

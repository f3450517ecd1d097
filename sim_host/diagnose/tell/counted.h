/*
 * A cause that is counted and not fitted: updates of the PWM that are missed.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_COUNTED_H
#define SIM_HOST_DIAGNOSE_TELL_COUNTED_H

#include "diagnose/measure/missed.h"
#include "diagnose/result.h"

/* Whether the count says more than the motor file does. */
bool counted_is_news(const missed_updates *found, const motor *file);

/* Adds it to d->cause and to the extended motor. `gain`: error with what was recorded / with what acted. */
void counted_tell(const missed_updates *found, const motor *file, double gain, diagnosis *d);

#endif

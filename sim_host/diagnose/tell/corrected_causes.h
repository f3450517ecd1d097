/*
 * Causes found by correcting rows, not by the fit: missed updates, speed lag, sensor faults, DC-link ripple.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_CORRECTED_CAUSES_H
#define SIM_HOST_DIAGNOSE_TELL_CORRECTED_CAUSES_H

#include "diagnose/identify/rows.h"
#include "diagnose/result.h"

/*
 * Adds them to d->cause and to the extended motor, in the order of the corrections. Each gain compares the extended drive's error on the
 * rows before and after the correction.
 */
void corrected_causes_tell(const diagnose_rows *r, const motor *file, double probability, diagnosis *d);

#endif

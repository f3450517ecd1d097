/*
 * Causes that the rows were mended of, and that no fit found (identify/mended.h).
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_MENDED_CAUSES_H
#define SIM_HOST_DIAGNOSE_TELL_MENDED_CAUSES_H

#include "diagnose/identify/rows.h"
#include "diagnose/result.h"

/* Adds them to d->cause and to the extended motor, in the order in which the rows were mended; each gain is that of the extended
 * drive on the rows before and after. */
void mended_causes_tell(const diagnose_rows *r, const motor *file, diagnosis *d);

#endif

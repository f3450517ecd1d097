/*
 * Updates of the PWM that were missed: cycles in which the command of the cycle before acted once more.
 *
 * Such a row errs by a known vector, what the command before would have done instead of its own; noise, a glitch or a
 * wrong parameter does not point there. Rows in which that vector is many deviations long are counted, and as many that
 * err by the opposite of it would say that nothing was missed.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_MISSED_H
#define SIM_HOST_DIAGNOSE_MEASURE_MISSED_H

#include "diagnose/identify/rows.h"

/*
 * Counts them by a drive that predicts the recording else. If there are any, the rows get the voltage that acted, and what they
 * were is kept where the motor file does not know that share. *mended: how many rows. False: out of memory.
 */
bool measure_missed(diagnose_rows *r, const averaged_drive *drive, const motor *file, size_t *mended);

#endif

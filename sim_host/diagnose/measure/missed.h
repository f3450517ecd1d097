/*
 * Updates of the PWM that were missed: cycles in which the command of the cycle before acted once more.
 *
 * Such a row errs by a known vector, what the command before would have done instead of its own; noise, a glitch or a
 * wrong parameter does not point there. Rows in which that vector is many deviations long are counted, and as many that
 * err by the opposite of it would say that nothing was missed. A disturbance that the controller answers, a loose contact of a
 * sensor say, is followed by rows that do point there: missed updates are reported only if they are half as many as the rows that
 * err by many deviations or more (of 32 recordings with missed updates 0.58 was the least, of 20 with a loose contact 0.13 the
 * most: second plant, seeds from 81000 and 82000).
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_MISSED_H
#define SIM_HOST_DIAGNOSE_MEASURE_MISSED_H

#include "diagnose/identify/rows.h"

/*
 * Counts them by a drive that predicts the recording else, commands that are late among it. If there are any, the rows get the
 * voltage that acted, and what they were is kept where the motor file does not know that share. The last argument: number of
 * corrected rows. False: out of memory.
 */
bool measure_missed(diagnose_rows *r, const averaged_drive *drive, const motor *file, size_t *corrected);

#endif

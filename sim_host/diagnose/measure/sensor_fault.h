/*
 * One of three current sensors that now and then shows something else: rows in which the three do not sum to what they sum to
 * else.
 *
 * What linear or bent sensors, offsets and noise leave of the sum is fitted over all rows; rows far beyond that are
 * reported. Whose sensor it was shows in the prediction: with its current taken from the other two they are predicted as well as all other
 * rows, and with another's worse than as they were recorded.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_SENSOR_FAULT_H
#define SIM_HOST_DIAGNOSE_MEASURE_SENSOR_FAULT_H

#include "diagnose/identify/rows.h"

/*
 * Looks for it by any drive that is roughly right, the motor file's. If there is one, its rows get the current that the other
 * two say; what they were is kept where the motor file does not know it. The last argument: number of
 * corrected rows. False: out of memory.
 */
bool measure_sensor_fault(diagnose_rows *r, const averaged_drive *drive, const motor *file,
                          size_t *corrected);

#endif

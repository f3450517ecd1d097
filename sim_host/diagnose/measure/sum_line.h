/*
 * The sum of the three measured currents. The star point floats: the sum is 0, whatever the machine does. A sine in it is picked up by
 * the sensors or their converter; a part that follows the currents is gains that differ, or crosstalk between the channels.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_SUM_LINE_H
#define SIM_HOST_DIAGNOSE_MEASURE_SUM_LINE_H

#include "diagnose/identify/rows.h"
#include "diagnose/result.h"

/*
 * Adds what is found to the structure, as certain: a part that follows the currents beyond the gains of `drive`, and a frequency that
 * at least two thirds of the stretches share. noise_A: rms noise of one sensor. False: out of memory.
 */
bool sum_line_tell(const diagnose_rows *r, const averaged_drive *drive, double noise_A,
                   diagnosis_structure *found);

#endif

/*
 * Finds rows in which a current sensor is at the end of its range. The current is then larger than its value, by an unknown amount. A
 * drive that has lost its operating point makes such rows.
 *
 * The end shows as one value that phases reach with both signs or in turn, again and again, with almost no values just below it. The
 * peaks of a current that is not cut have more rows below their top than at it. A current may also rest at one value; the sum of the
 * three currents shows the difference, as only a cut current changes that sum. With two sensors no end is found.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H

#include "data/recording.h"

/* The value at which the sensors end; infinity if none does in this recording. */
double row_clips_end_A(const recording *rec);

/* Whether one of the three sensors is at that value in row k. */
bool row_clips_at(const recording *rec, size_t k, double end_A);

#endif

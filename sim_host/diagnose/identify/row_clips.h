/*
 * Rows in which a current sensor stands at the end of its range: the current is larger than it says, and how much is not
 * known. A drive that has lost its operating point leaves such rows.
 *
 * The end shows as a value that phases reach with either sign or in turn, again and again, with next to nothing just below:
 * the peaks of a current that is not cut have more rows below than at their top. A current that rests at one value is told
 * from that by the sum of the three, which the cut one leaves; where two are measured nothing is said.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H

#include "data/recording.h"

/* The value at which the sensors end; infinity if none does in this recording. */
double row_clips_end_A(const recording *rec);

/* Whether one of the three stands there in row k. */
bool row_clips_at(const recording *rec, size_t k, double end_A);

#endif

/*
 * Finds rows in which a current sensor is at the end of its range. The current is then larger than its value, by an unknown amount. A
 * drive that has lost its operating point makes such rows.
 *
 * A reading that rests at its largest value does not show this by itself: a current may rest or peak there. The sum of the three currents
 * does. If a current is cut, the sum moves while the reading rests, and it falls short: what is missing is the rest of that current.
 * With two sensors no end is found.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_CLIPS_H

#include "data/recording.h"

/* The value at which the sensors end; infinity if none does in this recording. */
double row_clips_end_A(const recording *rec);

/* Whether one of the three sensors is at that value in row k. */
bool row_clips_at(const recording *rec, size_t k, double end_A);

#endif

/*
 * Time stamps of few decimals. At 7 kHz stamps of 4 decimals step by 0.1 or 0.2 ms: unevenly, although the cycles
 * are even. Where rounding explains what steps do, every stamp lies within half a quantum of an even ladder; a step
 * that leaves the ladder is a gap, and the ladder's spacing, from whole stretches, is the control cycle.
 */
#ifndef SIM_HOST_DATA_TIME_STAMPS_H
#define SIM_HOST_DATA_TIME_STAMPS_H

#include "recording.h"

/*
 * `step` is the usual step of t_s. Marks in starts[rows] the rows that begin a stretch and returns the control cycle;
 * 0 if t_s is not rounded to a power of ten that matters beside the step. scratch[rows] is overwritten.
 */
double time_stamps_ladder(const recording *r, double step, unsigned char *starts, double *scratch);

#endif

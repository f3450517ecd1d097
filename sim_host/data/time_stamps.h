/*
 * Finds the control cycle from rounded time stamps. At 7 kHz, stamps of 4 decimals step by 0.1 or 0.2 ms although the cycles are equal.
 * If rounding explains the steps, every stamp lies within half a quantum of an evenly spaced grid. A step that leaves the grid is a gap.
 * The grid spacing, fitted over whole stretches, is the control cycle.
 */
#ifndef SIM_HOST_DATA_TIME_STAMPS_H
#define SIM_HOST_DATA_TIME_STAMPS_H

#include "recording.h"

/*
 * `step` is the usual step of t_s. Marks in starts[rows] the rows that begin a stretch and returns the control cycle;
 * 0 if t_s is not rounded to a power of ten that matters compared with the step. scratch[rows] is overwritten.
 */
double time_stamps_ladder(const recording *r, double step, unsigned char *starts, double *scratch);

#endif

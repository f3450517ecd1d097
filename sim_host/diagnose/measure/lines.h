/*
 * What the extended model leaves: lines in the spectrum of its innovations, seen from the rotor, run by run.
 * A line that keeps its multiple of the electrical frequency belongs to the machine, one that keeps its
 * frequency to the supply.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_LINES_H
#define SIM_HOST_DIAGNOSE_MEASURE_LINES_H

#include "diagnose/identify/fit_data.h"
#include "diagnose/result.h"

/* excess: the extended error over the noise floor. False, or rows->no_memory set: out of memory. */
bool measure_lines(fit_data *d, const fit_state *s, double excess, diagnosis_structure *found);

#endif

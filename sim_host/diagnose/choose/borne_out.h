/*
 * Whether the causes that were found, all together, explain as much as they leave.
 *
 * What has no name in the list is taken in part by causes that have one: six terms of a flux map, say, take a fifth of what an
 * angle's error of the third order does, and each of them is certain. What is left then is the most of it, and a name for
 * the lesser part is a guess. Two measures of one question; neither needs to know what the effect is:
 *
 *     -2 log likelihood    the named ones' gain on the motor file's     what the filter's gain says there is still to gain
 *     power, held out      by what they reduce the one-cycle error    what of it they leave beyond the noise floor
 *
 * The first sees what one cycle hardly shows; the second counts where sensors have next to no noise, and a filter has no reason
 * to trust any model. Names stay if either has it that more is explained than left.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_BORNE_OUT_H
#define SIM_HOST_DIAGNOSE_CHOOSE_BORNE_OUT_H

#include "session.h"

/* What sensor noise alone would leave less, as -2 log likelihood: white innovations, a share (1 - gain) trusted by the filter. */
double borne_out_left(const group_noise *noise, size_t groups);

/* One-cycle errors and the floor in one unit; gained and left as -2 log likelihood. */
bool borne_out(double gained, double left, double file, double named, double floor);

#endif

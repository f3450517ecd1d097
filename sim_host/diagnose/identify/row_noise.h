/*
 * The part of the recorded voltages that is likely noise.
 *
 * A voltage is recorded as a share of the measured link, and so with the noise of that sensor. It drives the model, but not the machine.
 * Standing still, a machine remembers for L/R, and so sums up for hundreds of cycles what is slow in the stationary frame. A drive's
 * controller leaves nearly no voltage there: what is recorded is noise. Where nothing else moves the current, at one operating point, a
 * resistance twice too large then fits better than the true one, because it forgets sooner.
 *
 * The noise lies along the voltage, is white, and has one size, as a share of the voltage. What of the voltage's part along its mean the
 * part across does not tell, at the frequency where that is least, is taken for its variance. Its best estimate given the recorded
 * voltage is a filter of both parts, by their spectra (Wiener's, of two channels). How much of the estimate is no voltage is fitted with
 * every set of causes (P_U_NOISE): nothing where steps excite the drive, and about all at a constant speed.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROW_NOISE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROW_NOISE_H

#include "rows.h"

/* Fills in each row's u_noise_V from its voltages: zero at low speed, and in short stretches. False: out of memory. */
bool rows_find_voltage_noise(diagnose_rows *r);

#endif

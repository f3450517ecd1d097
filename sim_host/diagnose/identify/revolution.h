/*
 * Which revolution: a wrapped electrical angle leaves the mechanical one open by a multiple of 2 pi / pole
 * pairs, anew in each stretch. An angle error that repeats with the revolution fixes these multiples against
 * one another: its phasor is estimated stretch by stretch, and each stretch is turned so that the phasors
 * agree, with the motor file's where that has one.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H

#include "fit_data.h"

/* Whether the motor file itself has such an error: its phase is that of the true revolution, which every stretch is turned to. */
bool revolution_in_file(const fit_data *d);

/* Turns the mechanical angle of the stretches if there is evidence to do so, and says whether it did. False:
 * out of memory. */
bool revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned);

#endif

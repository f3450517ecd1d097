/*
 * Which revolution: a wrapped electrical angle leaves the mechanical one open by a multiple of 2 pi / pole
 * pairs, anew in each stretch. An angle error that repeats with the revolution fixes these multiples against
 * one another: its phasor is estimated stretch by stretch, and each stretch is turned so that the phasors
 * agree.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H

#include "fit_data.h"

/* Turns the mechanical angle of the stretches if there is evidence to do so, and says whether it did. False:
 * out of memory. */
bool revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned);

#endif

/*
 * Finds in which revolution each stretch of a recording began. From a wrapped electrical angle, the mechanical angle is known only up
 * to a multiple of 2 pi/pole pairs, which differs from stretch to stretch.
 *
 * An angle error that repeats with the revolution relates these multiples to one another. Its phasor is estimated for each stretch,
 * and each stretch is turned so that the phasors agree. If the motor file has such an error, they are turned to agree with that.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_REVOLUTION_H

#include "fit_data.h"

/* Whether the motor file has such an error. Its phase is that of the true revolution, and every stretch is turned to it. */
bool revolution_in_file(const fit_data *d);

/* Turns the mechanical angle of the stretches if there is enough evidence; *turned: whether it did. False: out of memory. */
bool revolution_align(fit_data *d, const fit_state *s, int pole_pairs, bool *turned);

#endif

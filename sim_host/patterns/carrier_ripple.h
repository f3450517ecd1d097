/* Distortion of space-vector modulation with a whole number of carrier periods a turn, to compare a pattern with. */
#ifndef SIM_HOST_PATTERNS_CARRIER_RIPPLE_H
#define SIM_HOST_PATTERNS_CARRIER_RIPPLE_H

#include "pattern_shape.h"

/*
 * As pattern_distortion, of centred pulses from a reference that is sampled once a carrier period: the rms over eight
 * positions of the carrier, harmonics up to 97 of both directions, without the constant flux that a carrier frequency which is no
 * multiple of three leaves. NAN above the linear range.
 */
double carrier_ripple(int pulses, double index, const pattern_weight *w);

#endif

/*
 * What a diagnosis found, put right in the drive: sensors, angle, DC link and the voltage that dead time
 * takes.
 *
 *     i     = (measured - o) / g                                   each phase
 *     theta = recorded - theta_0 - delay * turns                   turns, cycles, turns per cycle
 *     u_dc  = k_u * measured
 *     lost  = v_dead * sat(i / i_knee)                             each leg; sat(x) is x held to +-1
 *
 * Signs and laws are those of the recording's interface: a fitted value goes in as it is. The control cycle does
 * it all where its methods say `extended` (iqfoc/methods.h): samples are corrected first, duties compensated
 * last, at the current predicted for the valley from which they act.
 *
 * With the legs' losses made good, the voltage that the cycle commands is the voltage that acts, and its
 * predictor needs no correction. Where the compensation is not wanted, iqfoc_extension_acting says what acts.
 * Resistance, inductance and flux are parameters of the predictor (iqfoc/params.h); saturation and unequal
 * inductances have iqfoc/flux_predictor.h.
 *
 * What is not called is not linked: nothing else in the library refers to this.
 */
#ifndef IQFOC_EXTENSION_H
#define IQFOC_EXTENSION_H

#include "error.h"
#include "modulation.h"
#include "predictor.h"
#include "sample.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Per unit, IQ24 (iqfoc/extension_params.h makes them). Values in brackets: nothing to put right. */
typedef struct iqfoc_extension {
    iqfoc_abc_t i_offset;       /* o: -1 ... 1 of the rated peak current (0) */
    iqfoc_abc_t i_gain_inverse; /* 1/g: 0.5 ... 2 (1) */
    iq24_t theta_0;             /* recorded - true angle, turns: -0.5 ... 0.5 (0) */
    iq24_t theta_delay;         /* the angle is read so many cycles after the currents: -8 ... 8 (0) */
    iq24_t k_u;                 /* true over measured DC link: 0.5 ... 2 (1) */
    iq24_t v_dead;              /* of the nominal DC link: -0.25 ... 0.25 (0) */
    iq24_t knee_inverse; /* rated peak current over i_knee: 0 ... 127; a knee below 0.8 % is taken as that */
    iq24_t saturation;   /* (rated peak current / I_sat)^2: 0 ... 4 (0) */
} iqfoc_extension_t;

/* Are all values within their ranges? Once, before the drive runs: the functions below rely on it. */
iqfoc_error_t iqfoc_extension_check(const iqfoc_extension_t *extension);

/*
 * Measured phase currents to true ones. In: per unit, |measured| <= 31. Out: held to +-15.9, what the cycle
 * takes. Largest error: 0.5 LSB.
 *
 * Range: |measured - o| <= 32, times 1/g <= 2 is at most 64: no wrap.
 */
iqfoc_abc_t iqfoc_extension_current(const iqfoc_extension_t *extension, iqfoc_abc_t measured);

/*
 * Recorded angle to true angle, turns; whole turns are immaterial. |turns| <= 1. Largest error: 0.5 LSB.
 *
 * Range: |delay turns| <= 8; the sum wraps at 128 turns, which are whole.
 */
iq24_t iqfoc_extension_angle(const iqfoc_extension_t *extension, iq24_t theta, iq24_t turns);

/* A sample before the cycle sees it: currents (and their means, where a port has them), angle, DC link. */
void iqfoc_extension_sample(const iqfoc_extension_t *extension, iqfoc_sample_t *sample);

/*
 * Voltage that each leg loses at these true currents: |lost| <= |v_dead|. In: per unit, any. Largest error:
 * 0.63 LSB, the quotient's 0.5 LSB times v_dead and one more rounding.
 */
iqfoc_abc_t iqfoc_extension_lost(const iqfoc_extension_t *extension, iqfoc_abc_t i);

/*
 * The voltage that acts where u was commanded on the measured DC link: k_u u less what the legs lose, without
 * what they have in common, which the star point takes. In: |u| <= 16 a component, i: |component| <= 64.
 * Largest error with the phases of i as iqfoc_clarke_inverse gives them: 2.1 LSB (of 300000 drawn 1.6).
 *
 * Range: |k_u u| <= 32, and the lost vector is within 1/3: no wrap.
 */
iqfoc_ab_t iqfoc_extension_acting(const iqfoc_extension_t *extension, iqfoc_ab_t u, iqfoc_ab_t i);

/*
 * Adds to each duty what its leg will lose at current i, the current of the span in which the duties act (the
 * cycle's prediction i_next). A leg that does not switch, at 0 or 1, loses nothing and stays; the others are
 * held to 0 ... 1, where compensation ends as the voltage does. u_dc_inverse: 0 < u_dc_inverse <= 2. Largest
 * error: 1.8 LSB.
 *
 * Range: |lost u_dc_inverse| <= 0.5, so the sum lies within -0.5 ... 1.5 ahead of the clamp.
 */
void iqfoc_extension_compensate(const iqfoc_extension_t *extension, iqfoc_duties_t *duties, iqfoc_abc_t i,
                                iq24_t u_dc_inverse);

/*
 * The coefficients of iqfoc/predictor.h for the inductance at current i, L(|i|) = L_0/(1 + (|i|/I_sat)^2):
 * k_u, k_r and k_psi of L_0, times 1 + (|i|/I_sat)^2. Division free, but no part of the fast path: the
 * current's size changes slowly. Held at the ends of the predictor's ranges, and at |i| = I_sat, beyond which
 * the law has no current. |component of i| <= 5. Largest error: 2.5 LSB per unit of the coefficient, and
 * 0.5 LSB.
 *
 * Range: |i|^2 <= 50 and 50 * 4 = 200 would not fit: the product saturates, then the factor is held to 2; 16
 * * 2 fits.
 */
iqfoc_predictor_t iqfoc_extension_saturate(const iqfoc_extension_t *extension,
                                           const iqfoc_predictor_t *at_zero, iqfoc_ab_t i);

#ifdef __cplusplus
}
#endif

#endif

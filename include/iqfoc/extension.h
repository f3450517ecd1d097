/*
 * Corrects samples and voltages of a drive by the results of a diagnosis: current sensors, angle, DC link, and the voltage that a dead
 * time takes.
 *
 *     i     = (measured - o) / g                                   each phase
 *     theta = recorded - theta_0 - delay * speed                   turns, cycles, turns per cycle
 *     u_dc  = k_u * measured
 *     lost  = v_dead * sat(i / i_knee)                             each leg; sat(x) is x held to +-1
 *
 * Signs and equations are those of docs/interfaces.md: a fitted value is used unchanged. The control cycle applies all corrections if its
 * methods have `extended` (iqfoc/methods.h). It corrects the samples first. It compensates the duties last, at the current predicted for
 * the valley from which they act.
 *
 * With the legs' losses compensated, the commanded voltage acts, and the predictor needs no correction. Without the compensation,
 * iqfoc_extension_acting gives the voltage that acts. Resistance, inductance and flux linkage are parameters of the predictor
 * (iqfoc/params.h). Unequal inductances need iqfoc/predictor_salient.h or iqfoc/flux_predictor.h, saturation needs the latter, or
 * iqfoc/flux_map.h.
 *
 * The linker leaves these functions out of a drive whose methods do not have `extended`.
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

/* Per unit, IQ24 (iqfoc/extension_params.h makes them). Values in brackets: no correction. */
typedef struct iqfoc_extension {
    iqfoc_abc_t i_offset;       /* o: -1 ... 1 of the rated peak current (0) */
    iqfoc_abc_t i_gain_inverse; /* 1/g: 0.5 ... 2 (1) */
    iq24_t theta_0;             /* recorded - true angle, turns: -0.5 ... 0.5 (0) */
    iq24_t theta_delay; /* angle delay: the angle is read this many cycles after the currents, -8 ... 8 (0) */
    iq24_t k_u;         /* true over measured DC link: 0.5 ... 2 (1) */
    iq24_t v_dead;      /* voltage lost by each leg, per unit of the nominal DC link: -0.25 ... 0.25 (0) */
    iq24_t knee_inverse; /* rated peak current over i_knee: 0 ... 127; a knee below 0.8 % counts as 0.8 % */
    iq24_t saturation;   /* (rated peak current / I_sat)^2: 0 ... 4 (0) */
} iqfoc_extension_t;

/*
 * Checks that all values are within their ranges. Call it once before the drive runs: the functions below rely on it.
 * They only read the extension, so an interrupt may call them.
 */
iqfoc_error_t iqfoc_extension_check(const iqfoc_extension_t *extension);

/*
 * Measured phase currents to true ones. In: per unit, |measured| <= 31. Out: held to +-15.9, what the cycle
 * takes. Largest error: 0.5 LSB.
 *
 * Range: |measured - o| <= 32, times 1/g <= 2 is at most 64: no wrap.
 */
iqfoc_abc_t iqfoc_extension_current(const iqfoc_extension_t *extension, iqfoc_abc_t measured);

/*
 * Recorded angle to true angle, turns; whole turns are immaterial. |speed| <= 1. Largest error: 0.5 LSB.
 *
 * Range: |delay speed| <= 8; the sum wraps at 128 turns, which are whole.
 */
iq24_t iqfoc_extension_angle(const iqfoc_extension_t *extension, iq24_t theta, iq24_t speed);

/* Corrects a sample before the cycle reads it: currents (and their means, if a port has them), angle, DC link. */
void iqfoc_extension_sample(const iqfoc_extension_t *extension, iqfoc_sample_t *sample);

/*
 * Voltage that each leg loses at these true currents: |lost| <= |v_dead|. In: per unit, any. Largest error:
 * 0.63 LSB, the quotient's 0.5 LSB times v_dead and one more rounding.
 */
iqfoc_abc_t iqfoc_extension_lost(const iqfoc_extension_t *extension, iqfoc_abc_t i);

/*
 * The voltage that acts if u is commanded on the measured DC link: k_u u minus the legs' lost voltage without its
 * zero sequence, which the star point takes. In: |u| <= 16 a component, i: |component| <= 64. Largest error with the
 * phases of i as iqfoc_clarke_inverse gives them: 2.1 LSB (of 300000 drawn 1.6).
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
 * The coefficients of iqfoc/predictor.h for the inductance at current i, L(|i|) = L_0/(1 + (|i|/I_sat)^2): k_u, k_r
 * and k_psi of L_0, times 1 + (|i|/I_sat)^2. It needs no division, but is not made for every cycle: the length of the
 * current changes slowly. The coefficients are held to the predictor's ranges, and to those at |i| = I_sat, beyond
 * which the model has no solution. |component of i| <= 5. Largest error: 2.5 LSB per unit of the coefficient, and 0.5
 * LSB.
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

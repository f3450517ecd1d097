/*
 * Mean current over a control cycle: what a controller of mean dq currents should be fed.
 *
 * Averaging phase currents and transforming the mean with one angle (the middle's) is wrong when the rotor
 * turns far within the cycle: 5.3 % of the current in six-step. 2016 derives the correction; in this form
 *
 *     i_dq = e^(-j theta_m) [ s1 i_mean - j s2 (i(T) - i(0)) ]
 *
 * it needs no normalisation of modulus and angle, no division and no arc tangent. 2019 derives the mean of
 * the phase currents themselves from the sample at the start of the cycle:
 *
 *     i_mean = i + (T/2L)(u - R i) - (psi phi/L) e^(j theta_m) [ s2 + (j/2) s1 ]
 *
 * In this form it holds at standstill too (the paper's divides by the speed).
 */
#ifndef IQFOC_MEAN_CURRENT_H
#define IQFOC_MEAN_CURRENT_H

#include "iq24_math.h"
#include "predictor.h"
#include "rotor.h"
#include "vector.h"

/*
 * Correction of a discrete-angle mean current, general form: 2016 (10).
 *
 * i_mean: mean of the stationary current over the cycle; delta: i(T) - i(0), the change over it, both IQ24
 * per unit, |component| <= 32 and |delta| <= 32. rotor: s1 and s2 of the speed. sc_mid: of the angle at
 * mid-cycle. Exact for currents that change linearly in the stationary frame. Out: dq, per unit; no overflow
 * in that range. Largest error with s1, s2 and sine as given: 1.3 LSB.
 */
iqfoc_dq_t iqfoc_mean_current_correct(iqfoc_ab_t i_mean, iqfoc_ab_t delta, const iqfoc_rotor_t *rotor,
                                      iq24_sincos_t sc_mid);

/*
 * The same where the dq current is the same at both ends of the cycle (steady state): 2016 (9).
 *
 *     i_dq = e^(-j theta_m) i_mean [ s1 + 2 tan(phi/2) s2 ]
 *
 * i_mean: per unit, |component| <= 32. gain: iqfoc_rotor_steady_gain of the speed, <= 1.37. Out: dq, |dq|
 * <= 62. Largest error with gain and sine as given: 1.3 LSB.
 */
iqfoc_dq_t iqfoc_mean_current_correct_steady(iqfoc_ab_t i_mean, iq24_t gain, iq24_sincos_t sc_mid);

/*
 * Quasi-discrete mean of the phase currents over the cycle that begins now: 2019 (10), its third term mended
 * (docs/equations.md, errata).
 *
 * i: current at the start of the cycle, |component| <= 32; u: the voltage that acts during it, |component| <=
 * 2; sc_mid: of the angle at mid-cycle. Out: stationary frame, saturates at the ends of IQ24. Largest error
 * against the formula in double with the same coefficients, s1, s2 and sine: 1.1 LSB.
 */
iqfoc_ab_t iqfoc_mean_current_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                             const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid);

#endif

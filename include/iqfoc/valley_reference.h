/*
 * Sampling-instant set-point: the current at the valleys whose mean over each cycle, as seen from the turning rotor,
 * is the reference.
 *
 * Torque follows the mean current, but a predictive controller sets the current at the instants between two voltages.
 * At a low switching-to-fundamental ratio the two differ much. Without R i, the flux linkage changes linearly in the
 * stationary frame while a voltage acts: from psi_v at one valley to psi_v e^(j phi) at the next. Its mean, seen from
 * the rotor (2016 (10)), is
 *
 *     e^(-j phi/2) [ s1 (1 + e^(j phi))/2 - j s2 (e^(j phi) - 1) ] psi_v = s1^2 psi_v,
 *
 * since cos(phi/2) + phi s2 = s1. With psi = L i + psi_f,
 *
 *     i_d = (mean_d + k_psi)/s1^2 - k_psi,      i_q = mean_q/s1^2.
 *
 * Exact in steady state for R = 0; docs/loops.md has the error with R. For k_psi = 3 at a ratio of 5 the valley
 * current differs from the mean by 43 % of the rated current. All functions only read their arguments: any context.
 */
#ifndef IQFOC_VALLEY_REFERENCE_H
#define IQFOC_VALLEY_REFERENCE_H

#include "iq24_math.h"
#include "rotor.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Compute it when the speed changes. */
typedef struct {
    iq24_t gain;      /* 1/s1^2: 1 ... 1.4625 */
    iq24_t magnet_pu; /* k_psi (1/s1^2 - 1): 0 ... 3.7 */
} iqfoc_valley_reference_t;

/*
 * 1/d to nearest, 1/2 <= d <= 1; a smaller d is taken as 1/2. As iq24_div(IQ24_ONE, d), by one division of the core's
 * in place of four.
 *
 * Range: with d = 2^8 n + f, 2^15 <= n <= 2^16, q is 2^32/n rounded down, below 2^17; its remainder, 2^40 - d q, lies
 * in -2^25 ... 2^24, so that the low word is all of it. q/2^40 instead of 1/d makes the correction too small, by 1/32
 * at most, and it is rounded down: `low` is too small by 1 1/32 at most, and its remainder lies in 0 ... 1.04 d. The
 * nearest is `low` or one more. There is no tie: 2^49 is no odd multiple of d.
 */
static inline iq24_t iqfoc_valley_gain(iq24_t square)
{
    const iq24_t d = iq24_max(square, IQ24_ONE / 2);
    const int32_t q = (int32_t)(UINT32_MAX / ((uint32_t)d >> 8));
    const int32_t left = iq24_wrap((INT64_C(1) << 40) - (int64_t)d * q);
    const int32_t low = iq24_mac_high(256 * q, left, q);
    const int32_t rest = iq24_wrap((INT64_C(1) << 48) - (int64_t)d * low);
    return low + (rest >= d - (d >> 1));
}

/*
 * k_psi: psi_f/(L I_b), 0 ... 8. Largest error: gain 3.4 LSB where s1 is least, magnet 0.5 LSB + 3.4 LSB
 * per unit of k_psi (tests/unit/library/test_deadbeat.c finds 3.1).
 *
 * Range: s1 >= 0.8269, so s1^2 >= 0.6838 and its inverse <= 1.4625.
 */
static inline iqfoc_valley_reference_t iqfoc_valley_reference_at(const iqfoc_rotor_t *rotor, iq24_t k_psi)
{
    iqfoc_valley_reference_t reference;
    reference.gain = iqfoc_valley_gain(iq24_mul_round(rotor->s1, rotor->s1));
    reference.magnet_pu = iq24_mul_round(k_psi, reference.gain - IQ24_ONE);
    return reference;
}

/*
 * The valley current, rotor frame at the valley, of a mean current.
 *
 * mean: per unit, |component| <= 20. Out: |component| <= 33. Largest error with gain and magnet as given: 0.5
 * LSB.
 */
static inline iqfoc_dq_t iqfoc_valley_reference(const iqfoc_valley_reference_t *reference, iqfoc_dq_t mean)
{
    const iqfoc_dq_t valley = {iq24_add_wrap(iq24_mul_round(reference->gain, mean.d), reference->magnet_pu),
                               iq24_mul_round(reference->gain, mean.q)};
    return valley;
}

#ifdef __cplusplus
}
#endif

#endif

/*
 * Mean current over a control cycle: the feedback of a controller of mean dq currents.
 *
 * Usual practice averages the phase currents and transforms the mean with one angle, that of the middle. This is
 * wrong if the rotor turns far within the cycle: by 5.3 % of the current in six-step. 2016 derives the correction. In
 * the form
 *
 *     i_dq = e^(-j theta_m) [ s1 i_mean - j s2 (i(T) - i(0)) ]
 *
 * it needs no normalisation of modulus and angle, no division and no arc tangent. 2019 derives the mean of the phase
 * currents themselves from the sample at the start of the cycle:
 *
 *     i_mean = i + (T/2L)(u - R i) - (psi phi/L) e^(j theta_m) [ s2 + (j/2) s1 ]
 *
 * In this form it holds at standstill too (the paper's form divides by the speed).
 *
 * All functions only read their arguments: any context may call them.
 */
#ifndef IQFOC_MEAN_CURRENT_H
#define IQFOC_MEAN_CURRENT_H

#include "iq24_math.h"
#include "predictor.h"
#include "rotor.h"
#include "transform.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Correction of a discrete-angle mean current, general form: 2016 (10).
 *
 * i_mean: mean of the stationary current over the cycle; delta: i(T) - i(0), the change over it, both IQ24
 * per unit, |component| <= 48. rotor: s1 and s2 of the speed. sc_mid: of the angle at mid-cycle. Exact for
 * currents that change linearly in the stationary frame. Out: dq, per unit; no overflow in that range.
 * Largest error with s1, s2 and sine as given: 1.3 LSB.
 *
 * Range: v = s1 i_mean - j s2 delta; |s1 i| <= 48 and |s2 delta| <= 0.157 * 48 = 7.6, so |v| components
 * <= 55.6 <= 64, Park's precondition; the accumulators hold less than 2^54 + 2^52. Error: v is rounded once
 * (0.5 LSB a component, at most 0.71 in any direction) and Park once (0.5).
 */
static inline iqfoc_dq_t iqfoc_mean_current_correct(iqfoc_ab_t i_mean, iqfoc_ab_t delta,
                                                    const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid)
{
    const iq24_acc_t alpha = iq24_acc_mac(iq24_acc_mul(rotor->s1, i_mean.alpha), rotor->s2, delta.beta);
    const iq24_acc_t beta = iq24_acc_mac(iq24_acc_mul(rotor->s1, i_mean.beta), -rotor->s2, delta.alpha);
    const iqfoc_ab_t v = {iq24_acc_round(alpha), iq24_acc_round(beta)};
    return iqfoc_park(v, sc_mid);
}

/*
 * The same where the dq current is the same at both ends of the cycle (steady state): 2016 (9).
 *
 *     i_dq = e^(-j theta_m) i_mean [ s1 + 2 tan(phi/2) s2 ]
 *
 * i_mean: per unit, |component| <= 32. gain: iqfoc_rotor_steady_gain of the speed, <= 1.37. Out: dq, |dq|
 * <= 62. Largest error with gain and sine as given: 1.3 LSB.
 *
 * Range: |gain i| <= 1.37 * 32 = 43.9 <= 64, Park's precondition.
 */
static inline iqfoc_dq_t iqfoc_mean_current_correct_steady(iqfoc_ab_t i_mean, iq24_t gain,
                                                           iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t v = {iq24_mul_round(gain, i_mean.alpha), iq24_mul_round(gain, i_mean.beta)};
    return iqfoc_park(v, sc_mid);
}

/*
 * Quasi-discrete mean of the phase currents over the cycle that begins now, 2019 (10). The quasi-discrete prediction
 * of the cycle's end contains all but one of its terms:
 *
 *     i_mean = (i + i_next)/2 - (psi phi/L) s2 e^(j theta_m)
 *
 * i, i_next: current at the start, |component| <= 32, and predicted at the end, <= 80.8. Out: |component|
 * <= 59. Largest error with i_next as given: 1.5 LSB.
 *
 * Range: |i + i_next| <= 112.8; q = k_psi phi s2 <= 8 * 0.3270 = 2.7.
 * Error: the half is floored (0.5 LSB at most), q and its product are rounded.
 */
static inline iqfoc_ab_t iqfoc_mean_current_from_prediction(const iqfoc_predictor_t *predictor, iqfoc_ab_t i,
                                                            iqfoc_ab_t i_next, const iqfoc_rotor_t *rotor,
                                                            iq24_sincos_t sc_mid)
{
    const iq24_t q = iq24_mul_round(predictor->k_psi, rotor->phi_s2);
    const iqfoc_ab_t mean = {
        iq24_asr32(iq24_add_wrap(i.alpha, i_next.alpha), 1) - iq24_mul_round(q, sc_mid.cos),
        iq24_asr32(iq24_add_wrap(i.beta, i_next.beta), 1) - iq24_mul_round(q, sc_mid.sin)};
    return mean;
}

/*
 * The same mean as seen from the turning rotor: 2019 (10) and 2016 (10) in one. The s2 term of 2019 (10) lies on the
 * d axis at every angle and is s1 (psi phi/L) s2 there. (psi phi/L) s1 is the EMF w of the prediction, so that both
 * corrections become
 *
 *     i_dq = e^(-j theta_m) [ s1 (i + i_next)/2 - j s2 (i_next - i) ] - w s2
 *
 * A firmware without the control cycle calls this function; the cycle itself calls the next one.
 *
 * i, i_next: |component| <= 21.3 and <= 51.2 (docs/units.md: what a sampled current within 15.9 gives). w:
 * iqfoc_predictor_emf. Out: dq. Largest error with i_next and w as given: 1.92 LSB.
 *
 * Range: |i + i_next| and |i_next - i| <= 72.5 fit; in v |s1 (i + i_next)/2| <= 36.3 and |s2 delta| <= 11.4, together
 * within Park's 64; |w s2| <= 13.9 * 0.157 = 2.2. Error: v is computed twice as large until it is rounded down, by
 * less than 1 LSB a component; Park's sum and w s2 are rounded together.
 */
static inline iqfoc_dq_t iqfoc_mean_current_seen(iqfoc_ab_t i, iqfoc_ab_t i_next, iq24_t w,
                                                 const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid)
{
    const iq24_t two_s2 = 2 * rotor->s2;
    const iqfoc_ab_t sum = {iq24_add_wrap(i.alpha, i_next.alpha), iq24_add_wrap(i.beta, i_next.beta)};
    const iqfoc_ab_t delta = {iq24_sub_wrap(i_next.alpha, i.alpha), iq24_sub_wrap(i_next.beta, i.beta)};
    const iq24_acc_t alpha = iq24_acc_mac(iq24_acc_mul(rotor->s1, sum.alpha), two_s2, delta.beta);
    const iq24_acc_t beta = iq24_acc_mac(iq24_acc_mul(rotor->s1, sum.beta), -two_s2, delta.alpha);
    const iqfoc_ab_t v = {iq24_shift_wrap(alpha, IQ24_FRACTION_BITS + 1),
                          iq24_shift_wrap(beta, IQ24_FRACTION_BITS + 1)};
    const iq24_acc_t d = iq24_acc_mac(iq24_acc_mul(v.alpha, sc_mid.cos), v.beta, sc_mid.sin);
    const iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(v.beta, sc_mid.cos), v.alpha, -sc_mid.sin);
    const iqfoc_dq_t mean = {iq24_acc_round(iq24_acc_mac(d, -w, rotor->s2)), iq24_acc_round(q)};
    return mean;
}

/*
 * The same in the cycle's formats (iqfoc_predictor_step_q30): w in Q26, s1, s2, sine and cosine in Q30. Largest
 * error with them and i_next as given: 3.2 LSB.
 *
 * Range: as above; the products are below 2^60, their sums below 2^61.
 * Error: v is rounded down, and so are Park's sum and w s2.
 */
static inline iqfoc_dq_t iqfoc_mean_current_seen_q30(iqfoc_ab_t i, iqfoc_ab_t i_next, int32_t w_q26,
                                                     int32_t s1_q30, int32_t s2_q30, iq24_sincos_t sc_q30)
{
    const int32_t two_s2_q30 = 2 * s2_q30;
    const iqfoc_ab_t sum = {iq24_add_wrap(i.alpha, i_next.alpha), iq24_add_wrap(i.beta, i_next.beta)};
    const iq24_t delta_beta = iq24_sub_wrap(i_next.beta, i.beta);
    const iq24_t minus_delta_alpha = iq24_sub_wrap(i.alpha, i_next.alpha);
    const int64_t alpha = IQ24_SUM64(s1_q30, sum.alpha, two_s2_q30, delta_beta);
    const int64_t beta = IQ24_SUM64(s1_q30, sum.beta, two_s2_q30, minus_delta_alpha);
    const iqfoc_ab_t v = {iq24_shift_wrap(alpha, 31), iq24_shift_wrap(beta, 31)};
    const int64_t d = IQ24_SUM64(v.alpha, sc_q30.cos, v.beta, sc_q30.sin);
    const int64_t q = IQ24_SUM64(v.beta, sc_q30.cos, v.alpha, -sc_q30.sin);
    const iqfoc_dq_t mean = {iq24_sub_wrap(iq24_shift_wrap(d, 30), iq24_mul_high(w_q26, s2_q30)),
                             iq24_shift_wrap(q, 30)};
    return mean;
}

/*
 * The same from the sample at the start only: 2019 (10) with its third term corrected (docs/equations.md, errata).
 *
 * i: current at the start of the cycle, |component| <= 32; u: the voltage that acts during it, |component| <=
 * 2; sc_mid: of the angle at mid-cycle. Out: stationary frame, |component| <= 59. Largest error against the
 * formula in double with the same coefficients, phi s1, phi s2 and sine: 2 LSB.
 *
 * Range: the prediction is below 80.8 in size, as iqfoc_predictor_step shows.
 */
static inline iqfoc_ab_t iqfoc_mean_current_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i,
                                                           iqfoc_ab_t u, const iqfoc_rotor_t *rotor,
                                                           iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t i_next = iqfoc_predictor_quasi_discrete(predictor, i, u, rotor, sc_mid);
    return iqfoc_mean_current_from_prediction(predictor, i, i_next, rotor, sc_mid);
}

#ifdef __cplusplus
}
#endif

#endif

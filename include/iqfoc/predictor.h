/*
 * One-cycle current prediction of a non-salient machine in the stationary frame, both axes (all phases) at once. All
 * functions only read their arguments: any context may call them.
 *
 *     standard (forward Euler), 2019 (3):  i + (T/L)(u - R i) - j (psi phi/L) e^(j theta)
 *     quasi-discrete, 2019 (12):           i + (T/L)(u - R i) - j (psi phi/L) s1 e^(j theta_m)
 *
 * with theta the rotor angle at the start of the cycle, theta_m = theta + phi/2 at its middle, and u constant over
 * the cycle (the mean voltage that the PWM applies). In the second the EMF turns with the rotor. This is the only
 * difference, and it costs one multiplication by s1. Exact prediction is in predictor_exact.h, for salient machines
 * in predictor_salient.h.
 */
#ifndef IQFOC_PREDICTOR_H
#define IQFOC_PREDICTOR_H

#include "iq24_math.h"
#include "rotor.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The machine's coefficients: per unit, IQ24, made by iqfoc/params.h (firmware) or the host's parameter conversion.
 * I_b, U_b: the current and voltage base. Each coefficient is rounded to 0.5 LSB.
 */
typedef struct iqfoc_predictor {
    iq24_t k_u;   /* T U_b / (L I_b): per-unit current per per-unit voltage and cycle; 0 < k_u <= 16 */
    iq24_t k_r;   /* R T / L; 0 <= k_r <= 1 */
    iq24_t k_psi; /* psi_f / (L I_b): EMF per radian of the rotor; 0 <= k_psi <= 8; 0 for an RL load */
} iqfoc_predictor_t;

/*
 * The EMF of a cycle in the quasi-discrete prediction, w = (psi phi/L) s1: current per cycle.
 *
 * Range: |k_psi phi s1| <= 8 * 1.7321 = 13.9. Error: 0.5 LSB.
 */
static inline iq24_t iqfoc_predictor_emf(const iqfoc_predictor_t *predictor, const iqfoc_rotor_t *rotor)
{
    return iq24_mul_round(predictor->k_psi, rotor->phi_s1);
}

/*
 * i + k_u u - k_r i - j w (cos + j sin), that is alpha + w sin and beta - w cos: the common step of both predictions.
 *
 * Range: |(1 - k_r) i| <= 32, |k_u u| <= 32 and |w| <= 8 * 2.0944 = 16.8 in per unit: the sum is below 80.8
 * in size, so it fits, and in the accumulator below 2^55. Error: one rounding, 0.5 LSB. -w is exact: |w| <
 * 2^31.
 */
static inline iqfoc_ab_t iqfoc_predictor_step(const iqfoc_predictor_t *p, iqfoc_ab_t i, iqfoc_ab_t u,
                                              iq24_t w, iq24_sincos_t sc)
{
    const iq24_t stays = IQ24_ONE - p->k_r;
    const iq24_acc_t alpha = iq24_acc_mac(iq24_acc_mul(i.alpha, stays), p->k_u, u.alpha);
    const iq24_acc_t beta = iq24_acc_mac(iq24_acc_mul(i.beta, stays), p->k_u, u.beta);
    const iqfoc_ab_t next = {iq24_acc_round(iq24_acc_mac(alpha, w, sc.sin)),
                             iq24_acc_round(iq24_acc_mac(beta, -w, sc.cos))};
    return next;
}

/*
 * Standard prediction, 2019 (3): the current at the start of the next cycle.
 *
 * i, u: per unit, |component| <= 32 and <= 2. rotor: of the speed. sc: sine and cosine of theta, the angle at
 * the start. Out: per unit, |component| <= 80.8: no overflow in that range, beyond it the result wraps.
 * Largest error against the formula in double with the same coefficients, phi and sine: 1 LSB.
 *
 * Range: |k_psi phi| <= 8 * 2.0944 = 16.8.
 */
static inline iqfoc_ab_t iqfoc_predictor_euler(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                               const iqfoc_rotor_t *rotor, iq24_sincos_t sc)
{
    return iqfoc_predictor_step(predictor, i, u, iq24_mul_round(predictor->k_psi, rotor->phi), sc);
}

/*
 * Quasi-discrete prediction, 2019 (12). As above, but sc is of theta_m, the angle at the middle of the cycle.
 * Largest error against the formula in double with the same coefficients, phi s1 and sine: 1 LSB.
 */
static inline iqfoc_ab_t iqfoc_predictor_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i,
                                                        iqfoc_ab_t u, const iqfoc_rotor_t *rotor,
                                                        iq24_sincos_t sc_mid)
{
    return iqfoc_predictor_step(predictor, i, u, iqfoc_predictor_emf(predictor, rotor), sc_mid);
}

/*
 * The same in the formats that need the fewest instructions in a cycle: w in Q26, sine and cosine in Q30
 * (iq24_sincos_q30_inline), two floors in place of one rounding.
 *
 * i, u: per unit, |component| <= 32 and <= 2; |w| <= 13.9, below 2^30 in Q26. Largest error against the formula
 * in double with the same coefficients, w and sine: 2 LSB.
 *
 * Range: the sum of the first two terms is below 64, the EMF's high word below 13.9.
 */
static inline iqfoc_ab_t iqfoc_predictor_step_q30(const iqfoc_predictor_t *p, iqfoc_ab_t i, iqfoc_ab_t u,
                                                  int32_t w_q26, iq24_sincos_t sc_q30)
{
    iq24_t k_u;
    iq24_t k_r;
    IQ24_LOAD_PAIR(k_u, k_r, p->k_u, p->k_r);
    const iq24_t stays = IQ24_ONE - k_r;
    const iq24_acc_t alpha = IQ24_SUM64(i.alpha, stays, k_u, u.alpha);
    const iq24_acc_t beta = IQ24_SUM64(i.beta, stays, k_u, u.beta);
    const iqfoc_ab_t next = {iq24_mac_high(iq24_acc_trunc(alpha), w_q26, sc_q30.sin),
                             IQ24_HIGH_SUB(iq24_acc_trunc(beta), w_q26, sc_q30.cos)};
    return next;
}

#ifdef __cplusplus
}
#endif

#endif

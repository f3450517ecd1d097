/*
 * Standard and quasi-discrete prediction: 2019 (3) and (12), in the form of docs/equations.md.
 */
#include "iqfoc/predictor.h"

/*
 * i + k_u u - k_r i - j w (cos + j sin), that is alpha + w sin and beta - w cos.
 *
 * Range: |i 2^24| <= 2^53, |k_u u| <= 2^29 2^25 = 2^54, |k_r i| <= 2^24 2^29 = 2^53, |w sin| <= 2^31 2^24 =
 * 2^55: their sum is below 2^57, within int64. The result may leave IQ24 and is saturated. Error: one
 * rounding, 0.5 LSB.
 */
static iqfoc_ab_t step(const iqfoc_predictor_t *p, iqfoc_ab_t i, iqfoc_ab_t u, iq24_t w, iq24_sincos_t sc)
{
    iq24_acc_t alpha = iq24_acc_mul(i.alpha, IQ24_ONE - p->k_r);
    iq24_acc_t beta = iq24_acc_mul(i.beta, IQ24_ONE - p->k_r);
    alpha = iq24_acc_mac(alpha, p->k_u, u.alpha);
    beta = iq24_acc_mac(beta, p->k_u, u.beta);
    const iqfoc_ab_t next = {iq24_acc_sat(iq24_acc_mac(alpha, w, sc.sin)),
                             iq24_acc_sat(iq24_acc_msu(beta, w, sc.cos))};
    return next;
}

/* w = k_psi x: |k_psi| <= 32 and |x| <= 1/3 give |w| <= 10.7, within iq24_t. */
iqfoc_ab_t iqfoc_predictor_euler(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                 const iqfoc_rotor_t *rotor, iq24_sincos_t sc)
{
    return step(predictor, i, u, iq24_mul_round(predictor->k_psi, rotor->turns), sc);
}

/* w = k_psi x s1: |s1| <= 1 keeps the range of the above; two roundings, together below 1 LSB. */
iqfoc_ab_t iqfoc_predictor_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                          const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid)
{
    const iq24_t w = iq24_mul_round(iq24_mul_round(predictor->k_psi, rotor->turns), rotor->s1);
    return step(predictor, i, u, w, sc_mid);
}

/*
 * Mean currents: 2016 (9), (10) and 2019 (10), in the form of docs/equations.md.
 */
#include "iqfoc/mean_current.h"

#include "iqfoc/transform.h"

/*
 * v = s1 i_mean - j s2 delta, then Park.
 *
 * Range: |s1 i| <= 32 and |s2 delta| <= 0.157 32 = 5, so |v| components <= 37.1 <= 64, Park's precondition;
 * the accumulators hold 2^24 2^29 + 2^22 2^29 < 2^54. Error: v is rounded once (0.5 LSB a component, at most
 * 0.71 in any direction) and Park once (0.5).
 */
iqfoc_dq_t iqfoc_mean_current_correct(iqfoc_ab_t i_mean, iqfoc_ab_t delta, const iqfoc_rotor_t *rotor,
                                      iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t v = {
        iq24_acc_round(iq24_acc_mac(iq24_acc_mul(rotor->s1, i_mean.alpha), rotor->s2, delta.beta)),
        iq24_acc_round(iq24_acc_msu(iq24_acc_mul(rotor->s1, i_mean.beta), rotor->s2, delta.alpha))};
    return iqfoc_park(v, sc_mid);
}

/*
 * Range: |gain i| <= 1.37 32 = 43.9 <= 64, Park's precondition.
 * Error: two roundings as above.
 */
iqfoc_dq_t iqfoc_mean_current_correct_steady(iqfoc_ab_t i_mean, iq24_t gain, iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t v = {iq24_mul_round(gain, i_mean.alpha), iq24_mul_round(gain, i_mean.beta)};
    return iqfoc_park(v, sc_mid);
}

/*
 * i + (k_u u - k_r i)/2 - w e^(j theta_m) (s2 + (j/2) s1), w = k_psi x.
 *
 * The sum is formed doubled: 2 i + k_u u - k_r i - w (2 s2 + j s1) e^(j theta_m), then halved with one
 * rounding. Range: |(2 - k_r) i| <= 2^25 2^29 = 2^54; |k_u u| <= 2^54; p = w s1 and q = 2 w s2 are at
 * most 10.7 and 3.4 in per unit, so |p sin| + |q cos| <= 2^52.9 + 2^50.8: the sum is below 2^56. After the
 * halving it may leave IQ24 and is saturated. Error: 0.25 LSB from w's rounding, 0.25 and 0.5 from p and q,
 * 0.5 from the last; bound in the header.
 */
iqfoc_ab_t iqfoc_mean_current_quasi_discrete(const iqfoc_predictor_t *predictor, iqfoc_ab_t i, iqfoc_ab_t u,
                                             const iqfoc_rotor_t *rotor, iq24_sincos_t sc_mid)
{
    const iq24_t two_less_kr = 2 * IQ24_ONE - predictor->k_r;
    const iq24_t w = iq24_mul_round(predictor->k_psi, rotor->turns);
    const iq24_t p = iq24_mul_round(w, rotor->s1);
    const iq24_t q = iq24_mul_round(w, 2 * rotor->s2);
    iq24_acc_t alpha = iq24_acc_mac(iq24_acc_mul(two_less_kr, i.alpha), predictor->k_u, u.alpha);
    iq24_acc_t beta = iq24_acc_mac(iq24_acc_mul(two_less_kr, i.beta), predictor->k_u, u.beta);
    alpha = iq24_acc_msu(iq24_acc_mac(alpha, p, sc_mid.sin), q, sc_mid.cos);
    beta = iq24_acc_msu(iq24_acc_msu(beta, p, sc_mid.cos), q, sc_mid.sin);
    const iqfoc_ab_t mean = {iq24_acc_sat(iq24_asr64(alpha, 1)), iq24_acc_sat(iq24_asr64(beta, 1))};
    return mean;
}

/*
 * Mean dq current over a PWM cycle as seen from the turning rotor, ripple included, for machines without saliency. It
 * needs the samples at both ends of the cycle, its duties and the speed. 2016 leaves it to future work.
 *
 *     i_dq = e^(-j theta_m) [   s1 (i + i_next)/2 + (rho s2/phi - j s2)(i_next - i)
 *                             + (rho - j phi)(k_u u_dc/24) V ]
 *            - k_psi (1 - s1^2)
 *
 * The first two terms are those of the smooth current, which is straight but for the bend by the resistance. The
 * third is the ripple's (ripple.h). The last one, on the d axis at every angle, is the bend by the EMF. Derivation,
 * and a map of where a simpler mean is enough: docs/mean-under-modulation.md.
 *
 * The second sample may be the one at the next valley, for the cycle that ended, or its prediction, for the cycle
 * that begins.
 */
#ifndef IQFOC_MEAN_MODULATED_H
#define IQFOC_MEAN_MODULATED_H

#include "predictor.h"
#include "ripple.h"
#include "rotor.h"
#include "transform.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Coefficients at one speed; IQ24. */
typedef struct {
    iq24_t half_s1; /* s1/2 */
    iq24_t s2;
    iq24_t bow;    /* correction coefficient of the resistance, rho s2/phi: 0 ... 0.084 */
    iq24_t emf;    /* k_psi (1 - s1^2): 0 ... 2.6 */
    iq24_t square; /* phi^2/80 */
    iq24_t along;  /* k_u rho/24 */
    iq24_t across; /* k_u phi/24 */
} iqfoc_mean_modulated_t;

/*
 * For a slower task. predictor: within its ranges. rotor: of the speed. To the bit: s1/2 and each product to
 * nearest, ties up, quotients by 24 and 80 towards 0; s2/phi by four terms of its series.
 */
iqfoc_mean_modulated_t iqfoc_mean_modulated_at_speed(const iqfoc_predictor_t *predictor,
                                                     const iqfoc_rotor_t *rotor);

/*
 * i, i_next: the currents at the start and at the end of the cycle, per unit, |component| <= 32. high: the
 * duties that acted, 0 ... 1. u_dc: the DC link, per unit of nominal, 0 ... 2. sc_mid: of the rotor angle at
 * mid-cycle. Out: dq, no overflow in that range.
 *
 * Largest error against the true mean of the switching-level drive, each motor of data/motors/ without saliency, SFFR
 * 6 and above, up to rated current (tests/unit/library/test_mean_modulated.c): 0.02 % of the rated current. The
 * neglected terms are of second order in R T/L. From the formula in double, all inputs rounded to IQ24, it departs by
 * at most 100 LSB (6e-6) in the cycles drawn there.
 *
 * Range: |s1 (i + i_next)/2| <= 32, |s2 delta| <= 10.1, |bow delta| <= 5.4 and the ripple's 1.1 are within
 * Park's 64.
 */
static inline iqfoc_dq_t iqfoc_mean_modulated(const iqfoc_mean_modulated_t *c, iqfoc_ab_t i,
                                              iqfoc_ab_t i_next, iqfoc_abc_t high, iq24_t u_dc,
                                              iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t sum = {iq24_add_wrap(i.alpha, i_next.alpha), iq24_add_wrap(i.beta, i_next.beta)};
    const iqfoc_ab_t delta = {iq24_sub_wrap(i_next.alpha, i.alpha), iq24_sub_wrap(i_next.beta, i.beta)};
    const iqfoc_ab_t v = iqfoc_ripple_vector(high, c->square, u_dc);
    iq24_acc_t alpha = iq24_acc_mac(IQ24_ACC_HALF, c->half_s1, sum.alpha);
    iq24_acc_t beta = iq24_acc_mac(IQ24_ACC_HALF, c->half_s1, sum.beta);
    alpha = iq24_acc_mac(iq24_acc_mac(alpha, c->bow, delta.alpha), c->s2, delta.beta);
    beta = iq24_acc_mac(iq24_acc_mac(beta, c->bow, delta.beta), -c->s2, delta.alpha);
    alpha = iq24_acc_mac(iq24_acc_mac(alpha, c->along, v.alpha), c->across, v.beta);
    beta = iq24_acc_mac(iq24_acc_mac(beta, c->along, v.beta), -c->across, v.alpha);
    const iqfoc_ab_t mean = {iq24_acc_trunc(alpha), iq24_acc_trunc(beta)};
    const iqfoc_dq_t seen = iqfoc_park(mean, sc_mid);
    const iqfoc_dq_t result = {iq24_sub_wrap(seen.d, c->emf), seen.q};
    return result;
}

#ifdef __cplusplus
}
#endif

#endif

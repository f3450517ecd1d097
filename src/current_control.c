/*
 * PI current control with decoupling and back-calculation (include/iqfoc/current_control.h).
 */
#include "iqfoc/current_control.h"

static iq24_t held(iq24_t u)
{
    return iq24_clamp(u, -IQFOC_CURRENT_CONTROL_LIMIT, IQFOC_CURRENT_CONTROL_LIMIT);
}

/*
 * I + k e, held.
 *
 * Range: |e| <= 64 and k <= 32 give |k e| <= 2048 in per unit: 2^59 in the accumulator. I 2^24 <= 2^51. The
 * sum is saturated to IQ24, then held.
 */
static iq24_t integrated(iq24_t integral, iq24_t k, iq24_t e)
{
    return held(iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(k, e), integral, IQ24_ONE)));
}

/*
 * Range: |e| <= 64 (a difference of two values within 32). |x x_q| <= 96/3 = 32, so each decoupling product
 * is at most 32 * 32 = 1024 in per unit (2^58 in the accumulator), the EMF 32; kp e <= 2^59. The sum stays
 * below 2^61.
 */
iqfoc_dq_t iqfoc_current_control_step(iqfoc_current_control_t *control,
                                      const iqfoc_current_control_gains_t *gains, iqfoc_dq_t i_ref,
                                      iqfoc_dq_t i, iq24_t turns)
{
    const iqfoc_dq_t e = {iq24_sub_wrap(i_ref.d, i.d), iq24_sub_wrap(i_ref.q, i.q)};
    const iq24_t reactance_d = iq24_mul_round(turns, gains->x_d);
    const iq24_t reactance_q = iq24_mul_round(turns, gains->x_q);
    iq24_acc_t d = iq24_acc_mac(iq24_acc_mul(gains->kp_d, e.d), control->integral.d, IQ24_ONE);
    iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(gains->kp_q, e.q), control->integral.q, IQ24_ONE);
    d = iq24_acc_msu(d, reactance_q, i.q);
    q = iq24_acc_mac(iq24_acc_mac(q, reactance_d, i.d), turns, gains->emf);
    const iqfoc_dq_t u = {held(iq24_acc_sat(d)), held(iq24_acc_sat(q))};
    control->integral.d = integrated(control->integral.d, gains->ki_d, e.d);
    control->integral.q = integrated(control->integral.q, gains->ki_q, e.q);
    return u;
}

/* |k_aw (scale - 1)| <= 1 and |u| <= 8: the product of `integrated` is at most 8 in per unit. */
void iqfoc_current_control_limited(iqfoc_current_control_t *control,
                                   const iqfoc_current_control_gains_t *gains, iqfoc_dq_t u, iq24_t scale)
{
    if (scale < IQ24_ONE) {
        const iq24_t back = iq24_mul_round(gains->anti_windup, scale - IQ24_ONE);
        control->integral.d = integrated(control->integral.d, back, u.d);
        control->integral.q = integrated(control->integral.q, back, u.q);
    }
}

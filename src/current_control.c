/*
 * Back-calculation anti-windup (include/iqfoc/current_control.h).
 */
#include "iqfoc/current_control.h"

/* Range: |k_aw (scale - 1)| <= 1 and |u| <= 16 in per unit, so the product is at most 2^52 in the
 * accumulator; |I| <= 2^51. */
void iqfoc_current_control_back(iqfoc_current_control_t *control, const iqfoc_current_control_gains_t *gains,
                                iqfoc_dq_t u, iq24_t scale)
{
    const iq24_t back = iq24_mul_round(gains->anti_windup, scale - IQ24_ONE);
    control->integral_d = iqfoc_current_control_hold(iq24_acc_mac(control->integral_d, back, u.d));
    control->integral_q = iqfoc_current_control_hold(iq24_acc_mac(control->integral_q, back, u.q));
}

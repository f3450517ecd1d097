/*
 * One cycle of deadbeat control (include/iqfoc/deadbeat.h). It uses three angles: the middles of this cycle and of
 * the next for the model, and the end of the next cycle for the reference.
 */
#include "iqfoc/deadbeat.h"

/* Range: half of |speed| <= 1/3 and twice that; angles wrap at 128 turns, which are whole. */
iqfoc_ab_t iqfoc_deadbeat_step(const iqfoc_deadbeat_t *deadbeat, iqfoc_ab_t i, iqfoc_ab_t u_now,
                               iqfoc_dq_t i_ref, iq24_t theta, iq24_t speed)
{
    const iq24_t mid = iq24_add_wrap(theta, iq24_asr32(speed, 1));
    const iqfoc_ab_t i_next = iqfoc_exact_step(&deadbeat->model, i, u_now, iq24_sincos(mid));
    const iq24_t end = iq24_add_wrap(theta, 2 * speed);
    const iqfoc_ab_t target =
        iqfoc_park_inverse(iqfoc_valley_reference(&deadbeat->reference, i_ref), iq24_sincos(end));
    return iqfoc_deadbeat_voltage(deadbeat, i_next, target, iq24_sincos(iq24_add_wrap(mid, speed)));
}

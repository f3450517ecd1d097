/* Deadbeat control with disturbance observer (include/iqfoc/deadbeat_drift.h). */
#include "iqfoc/deadbeat_drift.h"

static iqfoc_ab_t plus(iqfoc_ab_t a, iqfoc_ab_t b)
{
    const iqfoc_ab_t sum = {iq24_add_wrap(a.alpha, b.alpha), iq24_add_wrap(a.beta, b.beta)};
    return sum;
}

/*
 * As iqfoc_deadbeat_step. The disturbance of the second cycle is subtracted from the target in advance: a i + k_u u +
 * m must reach the rest.
 */
iqfoc_ab_t iqfoc_deadbeat_drift_step(iqfoc_deadbeat_drift_t *drift, const iqfoc_deadbeat_t *deadbeat,
                                     iq24_t gain, iqfoc_ab_t i, iqfoc_ab_t u_now, iqfoc_dq_t i_ref,
                                     iq24_t theta, iq24_t speed)
{
    const iq24_t mid = iq24_add_wrap(theta, iq24_asr32(speed, 1));
    const iq24_sincos_t sc_next = iq24_sincos(iq24_add_wrap(theta, speed));
    const iq24_sincos_t sc_end = iq24_sincos(iq24_add_wrap(theta, 2 * speed));
    if (drift->predicted) {
        const iqfoc_ab_t error = {iq24_sub_wrap(i.alpha, drift->i_next.alpha),
                                  iq24_sub_wrap(i.beta, drift->i_next.beta)};
        iqfoc_deadbeat_learn(&drift->drift, gain, error, theta);
    }
    const iqfoc_ab_t modelled = iqfoc_exact_step(&deadbeat->model, i, u_now, iq24_sincos(mid));
    drift->i_next = plus(modelled, iqfoc_park_inverse(drift->drift, sc_next));
    drift->predicted = true;
    const iqfoc_dq_t valley = iqfoc_valley_reference(&deadbeat->reference, i_ref);
    const iqfoc_dq_t aim = {valley.d - drift->drift.d, valley.q - drift->drift.q};
    return iqfoc_deadbeat_voltage(deadbeat, drift->i_next, iqfoc_park_inverse(aim, sc_end),
                                  iq24_sincos(iq24_add_wrap(mid, speed)));
}

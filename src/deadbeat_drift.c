/* Deadbeat control with a learnt drift (include/iqfoc/deadbeat_drift.h). */
#include "iqfoc/deadbeat_drift.h"

static iqfoc_ab_t plus(iqfoc_ab_t a, iqfoc_ab_t b)
{
    const iqfoc_ab_t sum = {iq24_add_wrap(a.alpha, b.alpha), iq24_add_wrap(a.beta, b.beta)};
    return sum;
}

/* Range: |drift| <= 4 and |gain error| <= 90.6 (Park of two currents within 64): within 95. */
static iq24_t learnt(iq24_t drift, iq24_t gain, iq24_t error)
{
    return iq24_clamp(iq24_add_wrap(drift, iq24_mul_round(gain, error)), -IQFOC_DEADBEAT_DRIFT_LIMIT,
                      IQFOC_DEADBEAT_DRIFT_LIMIT);
}

/* The current's own rounding, a quarter of an LSB a cycle, is far below what a sensor resolves. */
static void learn(iqfoc_deadbeat_drift_t *drift, iq24_t gain, iqfoc_ab_t i, iq24_t theta)
{
    const iqfoc_ab_t error = {
        iq24_clamp(iq24_sub_wrap(i.alpha, drift->i_next.alpha), IQ24(-32.0), IQ24(32.0)),
        iq24_clamp(iq24_sub_wrap(i.beta, drift->i_next.beta), IQ24(-32.0), IQ24(32.0))};
    const iqfoc_dq_t seen = iqfoc_park(error, iq24_sincos(theta));
    drift->drift.d = learnt(drift->drift.d, gain, seen.d);
    drift->drift.q = learnt(drift->drift.q, gain, seen.q);
}

/*
 * As iqfoc_deadbeat_step. The drift of the second cycle is taken off the target ahead: a i + k_u u + m
 * must reach what is left.
 */
iqfoc_ab_t iqfoc_deadbeat_drift_step(iqfoc_deadbeat_drift_t *drift, const iqfoc_deadbeat_t *deadbeat,
                                     iq24_t gain, iqfoc_ab_t i, iqfoc_ab_t u_now, iqfoc_dq_t i_ref,
                                     iq24_t theta, iq24_t turns)
{
    const iq24_t mid = iq24_add_wrap(theta, iq24_asr32(turns, 1));
    const iq24_sincos_t sc_next = iq24_sincos(iq24_add_wrap(theta, turns));
    const iq24_sincos_t sc_end = iq24_sincos(iq24_add_wrap(theta, 2 * turns));
    if (drift->predicted) {
        learn(drift, gain, i, theta);
    }
    const iqfoc_ab_t modelled = iqfoc_exact_step(&deadbeat->model, i, u_now, iq24_sincos(mid));
    drift->i_next = plus(modelled, iqfoc_park_inverse(drift->drift, sc_next));
    drift->predicted = true;
    const iqfoc_dq_t valley = iqfoc_valley_reference(&deadbeat->reference, i_ref);
    const iqfoc_dq_t aim = {valley.d - drift->drift.d, valley.q - drift->drift.q};
    return iqfoc_deadbeat_voltage(deadbeat, drift->i_next, iqfoc_park_inverse(aim, sc_end),
                                  iq24_sincos(iq24_add_wrap(mid, turns)));
}

/*
 * Deadbeat control that learns what its model gets wrong: the integrator that iqfoc/deadbeat.h has not.
 *
 * A wrong R, L or psi_f, dead time, and the error of a coarse predictor shift the current of every cycle by
 * an amount that stands still in the rotor frame as long as the drive does. That drift is the mean of the
 * prediction errors:
 *
 *     drift += gain e^(-j theta_k) (i_k - i^_k)
 *     i^_(k+1) = a i_k + k_u u_k + m_k + drift e^(j theta_(k+1))              and so again for valley k + 2
 *
 * gain 0 leaves the plain law. The drift settles in some 1/gain cycles. It mends the steady state of any
 * predictor; what a wrong model does to a step, it cannot know in advance.
 */
#ifndef IQFOC_DEADBEAT_DRIFT_H
#define IQFOC_DEADBEAT_DRIFT_H

#include "deadbeat.h"
#include "iq24_sincos.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero it to begin anew, and whenever a cycle was missed. */
typedef struct iqfoc_deadbeat_drift {
    iqfoc_dq_t drift;  /* current per cycle, held to +-4 */
    iqfoc_ab_t i_next; /* predicted for the next valley, the drift included */
    bool predicted;    /* i_next is of the last valley */
} iqfoc_deadbeat_drift_t;

#define IQFOC_DEADBEAT_DRIFT_LIMIT IQ24(4.0)

/*
 * The drift after a prediction error at a valley: stationary frame, each component held to +-32; theta: of that
 * valley.
 *
 * Range: |drift| <= 4 and |gain error| <= 45.3 (Park of two components within 32): within 50.
 */
static inline void iqfoc_deadbeat_learn(iqfoc_dq_t *drift, iq24_t gain, iqfoc_ab_t miss, iq24_t theta)
{
    const iqfoc_ab_t held = {IQ24_HOLD_POWER(miss.alpha, 29), IQ24_HOLD_POWER(miss.beta, 29)};
    const iqfoc_dq_t seen = iqfoc_park(held, iq24_sincos_inline(theta));
    const iq24_t d = iq24_add_wrap(drift->d, iq24_mul_round(gain, seen.d));
    const iq24_t q = iq24_add_wrap(drift->q, iq24_mul_round(gain, seen.q));
    drift->d = IQ24_HOLD_POWER(d, 26); /* IQFOC_DEADBEAT_DRIFT_LIMIT */
    drift->q = IQ24_HOLD_POWER(q, 26);
}

/*
 * iqfoc_deadbeat_step with what was learnt, after learning from this sample.
 *
 * gain: IQ24, 0 ... 1; docs/loops.md has what it costs in stability. The rest as iqfoc_deadbeat_step; the
 * currents there with 5.7 more for the drift.
 */
iqfoc_ab_t iqfoc_deadbeat_drift_step(iqfoc_deadbeat_drift_t *drift, const iqfoc_deadbeat_t *deadbeat,
                                     iq24_t gain, iqfoc_ab_t i, iqfoc_ab_t u_now, iqfoc_dq_t i_ref,
                                     iq24_t theta, iq24_t turns);

#ifdef __cplusplus
}
#endif

#endif

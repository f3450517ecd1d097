/*
 * Deadbeat control with disturbance observer: iqfoc/deadbeat.h without its steady-state error.
 *
 * A wrong R, L or psi_f, dead time, and the error of a coarse predictor shift the current of each cycle. The shift is
 * constant in the rotor frame while the operating point is. The disturbance estimate `drift` is a filtered mean of
 * the prediction errors:
 *
 *     drift += gain e^(-j theta_k) (i_k - i^_k)
 *     i^_(k+1) = a i_k + k_u u_k + m_k + drift e^(j theta_(k+1))              and the same for valley k + 2
 *
 * gain 0 leaves deadbeat control without observer. The estimate settles in about 1/gain cycles. It removes the
 * steady-state error of any predictor, but not the error of a wrong model during a step.
 */
#ifndef IQFOC_DEADBEAT_DRIFT_H
#define IQFOC_DEADBEAT_DRIFT_H

#include "deadbeat.h"
#include "iq24_sincos.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The state. Set it to zero at the start, and after each missed cycle. */
typedef struct iqfoc_deadbeat_drift {
    iqfoc_dq_t drift;  /* disturbance estimate: current per cycle, held to +-4 */
    iqfoc_ab_t i_next; /* predicted for the next valley, disturbance estimate included */
    bool predicted;    /* i_next was predicted at the last valley */
} iqfoc_deadbeat_drift_t;

#define IQFOC_DEADBEAT_DRIFT_LIMIT IQ24(4.0)

/*
 * Updates the disturbance estimate with a valley's prediction error `miss`: stationary frame, each component held to
 * +-32. theta: of that valley.
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
 * iqfoc_deadbeat_step with disturbance observer. It first updates the estimate with this sample. The firmware calls
 * it in the valley's interrupt if it does not use the control cycle (cycle.h), which has these steps itself.
 *
 * gain: IQ24, 0 ... 1; docs/loops.md has the stability margin. The other arguments as in iqfoc_deadbeat_step;
 * currents there with 5.7 more for the estimate.
 */
iqfoc_ab_t iqfoc_deadbeat_drift_step(iqfoc_deadbeat_drift_t *drift, const iqfoc_deadbeat_t *deadbeat,
                                     iq24_t gain, iqfoc_ab_t i, iqfoc_ab_t u_now, iqfoc_dq_t i_ref,
                                     iq24_t theta, iq24_t speed);

#ifdef __cplusplus
}
#endif

#endif

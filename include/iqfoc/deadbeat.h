/*
 * Deadbeat predictive current control with compensation of the computation delay.
 *
 * At valley k the voltage of the cycle that begins is already decided, and the voltage computed now acts from valley
 * k + 1. The controller predicts the current at valley k + 1. It then solves for the voltage that brings the current
 * to the reference at valley k + 2:
 *
 *     i_(k+1) = a i_k + k_u u_k + m_k,        u_(k+1) = (i_ref,(k+2) - a i_(k+1) - m_(k+1))/k_u
 *
 * a, k_u and m (the EMF's part, turned by the angle at mid-cycle) come from one predictor: exact, quasi-discrete or
 * standard. The caller puts it into `model` (predictor_exact.h, predictor_form.h). There is no integrator: a model
 * error becomes a current error.
 *
 * In use, with `rotor` of the speed:
 *
 *     iqfoc_deadbeat_t deadbeat = {
 *         .model = iqfoc_exact_at_speed(&law, rotor.speed),                  when the speed changes
 *         .k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26),                once
 *         .reference = iqfoc_valley_reference_at(&rotor, k_psi)};            when the speed changes
 *     u = iqfoc_deadbeat_step(&deadbeat, i, u_now, i_ref, theta, rotor.speed);     at each valley
 *     duties = iqfoc_modulate(u, u_dc_inverse, span_max);    u_now of the next valley: u times duties.scale
 */
#ifndef IQFOC_DEADBEAT_H
#define IQFOC_DEADBEAT_H

#include "predictor_exact.h"
#include "transform.h"
#include "valley_reference.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iqfoc_deadbeat {
    iqfoc_exact_t model; /* over one whole cycle, at the present speed; 1/64 <= k_u <= 16 */
    iq24_t k_u_inverse;  /* 1/k_u: per-unit voltage that moves the current by 1 in a cycle; 1/16 ... 64 */
    iqfoc_valley_reference_t reference; /* gain 1 and magnet 0 to control the valleys' current itself */
} iqfoc_deadbeat_t;

/* Limit of a voltage component: above any DC-link voltage, within the range of iqfoc_modulate. */
#define IQFOC_DEADBEAT_LIMIT IQ24(16.0)

/* 1/k_u to 0.5 LSB. 1/64 <= k_u <= 16; below that it saturates at 128. */
static inline iq24_t iqfoc_deadbeat_inverse(int32_t k_u_q26)
{
    return iq24_div(INT32_C(1) << 26, k_u_q26);
}

/*
 * The voltage that moves a component of the current by so much in a cycle, held to +-16.
 *
 * Range: |change| <= 128 and an inverse of at most 128 make 2^62 in Q48, and half an LSB more. Its high word is
 * Q15.16; held to 23 bits, +-64, it fits IQ24 when rounded, and a value above that limit is still above 16.
 */
static inline iq24_t iqfoc_deadbeat_component(iq24_t change, iq24_t k_u_inverse)
{
    const iq24_acc_t sum = iq24_acc_mac(IQ24_ACC_HALF, change, k_u_inverse);
    const int32_t high = IQ24_HOLD_BITS(iq24_wrap(iq24_asr64(sum, 32)), 23);
    const iq24_t u = iq24_acc_trunc(iq24_acc_join(high, (uint32_t)((uint64_t)sum & UINT32_MAX)));
    return IQ24_HOLD_POWER(u, 28); /* IQFOC_DEADBEAT_LIMIT */
}

/*
 * The voltage that brings the current from i to target over one cycle.
 *
 * i, target: per unit, |component| <= 32. sc_mid: of the rotor angle in the middle of that cycle. Out: each
 * component held to +-16. Where neither is held, iqfoc_exact_step with the result misses the target by at
 * most 1.5 LSB + 0.5 k_u (1 + |change|) LSB, change: what the voltage has to do to the current: 4 LSB where
 * both are about 1.5.
 *
 * Range: without voltage |i'| <= 32 + 16.8, so the difference is within 80.8 and does not wrap.
 */
IQFOC_STEP iqfoc_ab_t iqfoc_deadbeat_voltage(const iqfoc_deadbeat_t *deadbeat, iqfoc_ab_t i,
                                             iqfoc_ab_t target, iq24_sincos_t sc_mid)
{
    const iqfoc_ab_t alone = iqfoc_exact_left_alone(&deadbeat->model, i, sc_mid);
    const iq24_t inverse = deadbeat->k_u_inverse;
    const iqfoc_ab_t u = {iqfoc_deadbeat_component(iq24_sub_wrap(target.alpha, alone.alpha), inverse),
                          iqfoc_deadbeat_component(iq24_sub_wrap(target.beta, alone.beta), inverse)};
    return u;
}

/*
 * One control cycle: the voltage for the cycle after the one that begins now. The firmware calls it in the valley's
 * interrupt if it does not use the control cycle (cycle.h), which has these steps itself.
 *
 * i: sample at this valley, |component| <= 15, u_now: the voltage of the cycle that begins, |component| <= 1. i_ref:
 * reference of the mean current, rotor frame, |component| <= 20. theta: at this valley, turns: of the speed that
 * `deadbeat` was made for. Out: per unit, each component held to +-16; the modulator may have to shorten it.
 *
 * Range: |i_next| <= 15 + 16 + 20.8 with k_u |u| <= 16 and |w| <= 20.8 (both parts); the caller's current
 * limit keeps it far below. Past 32 the voltage is at its limit whatever i_next is.
 */
iqfoc_ab_t iqfoc_deadbeat_step(const iqfoc_deadbeat_t *deadbeat, iqfoc_ab_t i, iqfoc_ab_t u_now,
                               iqfoc_dq_t i_ref, iq24_t theta, iq24_t speed);

#ifdef __cplusplus
}
#endif

#endif

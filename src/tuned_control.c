/* The current controller of a design by `iqfoc tune` (include/iqfoc/tuned_control.h). */
#include "iqfoc/tuned_control.h"

#define DRIFT_LIMIT  IQ24(4.0)
#define OFFSET_LIMIT IQ24(1.0)

/* ---- The law at a speed ---- */

/*
 * entry/det in IQ24, of Q26 and Q52: both are first moved up to 30 bits, so that the quotient keeps 23.
 *
 * Range: |entry| <= 16 is 2^30 in Q26, and moved up it is still within 2^30; b lies in 2^29 ... 2^30. So the
 * ratio is within 2, and with |G^-1| <= 32 what it is moved by keeps it within IQ24; else it saturates.
 */
static iq24_t quotient(int32_t entry_q26, uint32_t entry_up, int32_t b, int32_t det_down)
{
    const int32_t a = iq24_wrap((int64_t)entry_q26 * (INT32_C(1) << entry_up));
    const int64_t ratio = iq24_div(a, b);
    const int32_t up = 26 - det_down - (int32_t)entry_up;
    return up >= 0 ? iq24_sat(ratio * (INT64_C(1) << up)) : iq24_sat(iq24_asr64(ratio, (uint32_t)-up));
}

/*
 * The inverse of G.
 *
 * Range: entries within 2^30 make products within 2^60 and det within 2^61; det >= 0.6 k_d k_q > 0, for the
 * voltage turns by at most a third of a turn within the cycle.
 */
static void invert(const iqfoc_salient_t *end, iqfoc_tuned_t *tuned)
{
    const int32_t dd = end->d.u_d_q26;
    const int32_t dq = end->d.u_q_q26;
    const int32_t qd = end->q.u_d_q26;
    const int32_t qq = end->q.u_q_q26;
    const int64_t det = IQ24_MUL64(dd, qq) - IQ24_MUL64(dq, qd);
    int32_t down = 0;
    while (iq24_asr64(det, (uint32_t)down) >= (INT64_C(1) << 30)) {
        down++;
    }
    const int32_t b = iq24_wrap(iq24_asr64(det, (uint32_t)down));
    const int32_t largest =
        iq24_max(iq24_max(iq24_abs_sat(dd), iq24_abs_sat(dq)), iq24_max(iq24_abs_sat(qd), iq24_abs_sat(qq)));
    uint32_t up = 0;
    while (up < 12 && largest < (INT32_C(1) << (29 - up))) {
        up++;
    }
    tuned->voltage_dd = quotient(qq, up, b, down);
    tuned->voltage_dq = quotient(iq24_sub_wrap(0, dq), up, b, down);
    tuned->voltage_qd = quotient(iq24_sub_wrap(0, qd), up, b, down);
    tuned->voltage_qq = quotient(dd, up, b, down);
}

/*
 * (1 - s1^2)/(1 - cos h), h = phi/2: the correction coefficient of the mean. The current bends within a cycle because
 * the magnet turns away under a flux that changes linearly; the coefficient is the bend's share in the mean. A power
 * series in h^2. Range: h^2 <= 1.097.
 */
static iq24_t bow_of(const iqfoc_rotor_t *rotor)
{
    const iq24_t h = iq24_asr32(rotor->phi, 1);
    const iq24_t x = iq24_mul_round(h, h);
    iq24_t sum = IQ24(0.00171958) + iq24_mul_round(x, IQ24(-0.0000132));
    sum = IQ24(-1.0 / 30.0) + iq24_mul_round(x, sum);
    return IQ24(2.0 / 3.0) + iq24_mul_round(x, sum);
}

iqfoc_tuned_t iqfoc_tuned_at_speed(const iqfoc_tuned_law_t *law, iq24_t speed)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iq24_sincos_t sc = iq24_sincos(rotor.speed);
    iqfoc_tuned_t tuned;
    iqfoc_salient_at_speed(&law->machine, rotor.speed, IQ24_ONE, &tuned.end, NULL);
    invert(&tuned.end, &tuned);
    tuned.keep_cos = iq24_mul_round(law->keep, sc.cos);
    tuned.keep_sin = iq24_mul_round(law->keep, sc.sin);
    tuned.reference = iqfoc_valley_reference_at(&rotor, iq24_asr32(law->machine.k_psi_d_q27 + 4, 3));
    tuned.bow = bow_of(&rotor);
    tuned.speed = rotor.speed;
    tuned.follow = law->follow;
    tuned.learn = law->learn;
    tuned.learn_offset = law->learn_offset;
    return tuned;
}

/* ---- The cycle ---- */

static iqfoc_dq_t plus(iqfoc_dq_t a, iqfoc_dq_t b)
{
    const iqfoc_dq_t sum = {iq24_add_wrap(a.d, b.d), iq24_add_wrap(a.q, b.q)};
    return sum;
}

static iqfoc_dq_t minus(iqfoc_dq_t a, iqfoc_dq_t b)
{
    const iqfoc_dq_t difference = {iq24_sub_wrap(a.d, b.d), iq24_sub_wrap(a.q, b.q)};
    return difference;
}

static iqfoc_dq_t held(iqfoc_dq_t x, iq24_t limit)
{
    const iqfoc_dq_t within = {iq24_clamp(x.d, -limit, limit), iq24_clamp(x.q, -limit, limit)};
    return within;
}

/* sum + gain error, held. Range: gain <= 1, |error| <= 43 and |sum| <= limit <= 4. */
static iqfoc_dq_t learnt(iqfoc_dq_t sum, iq24_t gain, iqfoc_dq_t error, iq24_t limit)
{
    const iqfoc_dq_t step = {iq24_mul_round(gain, error.d), iq24_mul_round(gain, error.q)};
    return held(plus(sum, step), limit);
}

/*
 * The offset in one cycle: mean of the currents at its two valleys minus the model's valley current for the cycle's
 * mean, ripple included.
 *
 * Range: |ends| <= 8 and |i_mid| held to 8 make |bow| <= 16, so |mean| <= 20.7 and |valley| <= 34.
 */
static iqfoc_dq_t offset_seen(const iqfoc_tuned_state_t *state, const iqfoc_tuned_t *tuned, iqfoc_dq_t i)
{
    const iqfoc_dq_t both = plus(state->i, i);
    const iqfoc_dq_t ends = {iq24_asr32(both.d, 1), iq24_asr32(both.q, 1)};
    const iqfoc_dq_t away = minus(held(state->i_mid, IQFOC_TUNED_CURRENT_LIMIT), ends);
    const iqfoc_dq_t smooth = {iq24_add_wrap(ends.d, iq24_mul_round(tuned->bow, away.d)),
                               iq24_add_wrap(ends.q, iq24_mul_round(tuned->bow, away.q))};
    return minus(ends, iqfoc_valley_reference(&tuned->reference, plus(smooth, state->ripple)));
}

static void learn(iqfoc_tuned_state_t *state, const iqfoc_tuned_t *tuned, iqfoc_dq_t i)
{
    const iqfoc_dq_t none = {0, 0};
    state->error = none;
    if (!state->predicted) {
        return;
    }
    const iqfoc_dq_t missed = minus(i, state->i_next);
    state->error = plus(missed, state->drift);
    state->drift = learnt(state->drift, tuned->learn, missed, DRIFT_LIMIT);
    if (state->has_mid) {
        const iqfoc_dq_t away = minus(offset_seen(state, tuned, i), state->offset);
        state->offset = learnt(state->offset, tuned->learn_offset, away, OFFSET_LIMIT);
    }
}

/* The valley current of a target, with the estimated offset. */
static iqfoc_dq_t valley_of(const iqfoc_tuned_t *tuned, iqfoc_dq_t aim, iqfoc_dq_t offset)
{
    return plus(iqfoc_valley_reference(&tuned->reference, aim), offset);
}

/* G^-1 need. */
static iqfoc_dq_t voltage_for(const iqfoc_tuned_t *tuned, iqfoc_dq_t need)
{
    const iq24_acc_t d = iq24_acc_mac(iq24_acc_mul(tuned->voltage_dd, need.d), tuned->voltage_dq, need.q);
    const iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(tuned->voltage_qd, need.d), tuned->voltage_qq, need.q);
    const iqfoc_dq_t u = {iq24_acc_sat(d), iq24_acc_sat(q)};
    return held(u, IQFOC_TUNED_VOLTAGE_LIMIT);
}

iqfoc_ab_t iqfoc_tuned_step(iqfoc_tuned_state_t *state, const iqfoc_tuned_t *tuned, iqfoc_ab_t i_ab,
                            iqfoc_ab_t u_now, iqfoc_dq_t i_ref, iq24_t theta)
{
    const iq24_sincos_t sc = iq24_sincos(theta);
    const iq24_sincos_t sc_next = iq24_sincos(iq24_add_wrap(theta, tuned->speed));
    const iqfoc_dq_t none = {0, 0};
    const iqfoc_dq_t i = held(iqfoc_park(i_ab, sc), IQFOC_TUNED_CURRENT_LIMIT);
    learn(state, tuned, i);
    const iqfoc_dq_t next = plus(iqfoc_salient_step(&tuned->end, i, iqfoc_park(u_now, sc)), state->drift);
    state->i_next = held(next, IQFOC_TUNED_CURRENT_LIMIT);
    const iqfoc_dq_t left_alone = plus(iqfoc_salient_step(&tuned->end, state->i_next, none), state->drift);
    /* At the start there is no earlier target: the first voltage aims at the whole reference. */
    state->aim = state->predicted ? state->aim : i_ref;
    const iqfoc_dq_t expected = valley_of(tuned, state->aim, state->offset);
    const iqfoc_dq_t off = state->predicted ? minus(state->i_next, expected) : none;
    const iqfoc_dq_t short_of = minus(i_ref, state->aim);
    const iqfoc_dq_t filtered = {iq24_sub_wrap(i_ref.d, iq24_mul_round(tuned->follow, short_of.d)),
                                 iq24_sub_wrap(i_ref.q, iq24_mul_round(tuned->follow, short_of.q))};
    state->aim = filtered;
    const iq24_sincos_t keep = {tuned->keep_sin, tuned->keep_cos};
    const iqfoc_dq_t wanted = valley_of(tuned, state->aim, state->offset);
    /* Turned back by phi: as Park turns a stationary vector into a frame that is phi ahead. */
    const iqfoc_ab_t off_ab = {off.d, off.q};
    const iqfoc_dq_t want = plus(wanted, iqfoc_park(off_ab, keep));
    const iqfoc_dq_t need = {iq24_sub_sat(want.d, left_alone.d), iq24_sub_sat(want.q, left_alone.q)};
    state->i = i;
    state->has_mid = false;
    state->predicted = true;
    const iqfoc_dq_t u = voltage_for(tuned, need);
    return iqfoc_park_inverse(u, sc_next);
}

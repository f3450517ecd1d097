/* Torque to current: MTPA, field weakening and limits (include/iqfoc/reference.h). */
#include "iqfoc/reference.h"

#include "iqfoc/iq24_math.h"

#include <stddef.h>

#define U_MAX        IQ24(1.5)
#define LEAST_TORQUE IQ24(0.25) /* per i_q, over that at i_d = 0 */
#define LOW_RISES    7          /* shift: a cycle's share of the distance */
#define LINK_GAIN    IQ24(64.0)
#define Z_LOWEST     IQ24(-12.0)

iqfoc_error_t iqfoc_reference_check(const iqfoc_reference_config_t *config)
{
    if (config == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!iq24_within(config->i_max, 1, IQ24(4.0)) || !iq24_within(config->i_d_min, -config->i_max, 0)) {
        return IQFOC_ERROR_CURRENT_LIMIT;
    }
    if (!iq24_within(iq24_mul_sat(config->saliency, config->i_max), IQ24(-11.0), IQ24(11.0))) {
        return IQFOC_ERROR_SALIENCY;
    }
    if (!iq24_within(config->gain, 0, IQ24(8.0)) || !iq24_within(config->share, IQ24(0.5), IQ24(1.125))) {
        return IQFOC_ERROR_WEAKENING;
    }
    return IQFOC_OK;
}

/*
 * Range: |i_q| <= i_max, so |x| <= 11, 1 + x^2 <= 122 and |x i_q| <= 44; the divisor is 2 ... 12.1.
 * Error: of x i_q 0.5 + 0.5 |i_q|, of 1 + r 1.1 times a quotient below 4, rounding; the rounded x counts twice
 * where it is large, over a root that is as large.
 */
static iq24_t most_torque_per_ampere(iq24_t saliency, iq24_t i_q)
{
    const iq24_t x = iq24_mul_round(saliency, i_q);
    /*@ assert reference: -184549377 <= x <= 184549377; */
    const iq24_t root = iq24_sqrt(IQ24_ONE + iq24_mul_round(x, x));
    const iq24_t i_d = iq24_div(iq24_mul_round(x, i_q), IQ24_ONE + root);
    /*@ assert reference: -67276636 <= i_d <= 67276636; */
    return -i_d;
}

/* (share u_limit)^2 - |u|^2. Range: components within 1.5, so 0 ... 4.5; (1.125 * 1.5)^2 = 2.85. */
static inline iq24_t voltage_left(iqfoc_dq_t u, iq24_t u_max)
{
    const iq24_t d = iq24_clamp(u.d, -U_MAX, U_MAX);
    const iq24_t q = iq24_clamp(u.q, -U_MAX, U_MAX);
    const iq24_acc_t asked = iq24_acc_mac(iq24_acc_mul(d, d), q, q);
    return iq24_acc_round(iq24_acc_mul(u_max, u_max) - asked);
}

/*
 * z within its ends. Range: |g left| <= 8 * 4.5 = 36 and |z| <= 12 in per unit: 2^54 in the accumulator.
 */
static void weaken(iqfoc_reference_t *reference, iq24_t gain, iq24_t left, iq24_t lowest)
{
    const iq24_acc_t sum = iq24_acc_mac(reference->weakening, gain, left);
    const iq24_acc_t low = iq24_acc_mul(lowest, IQ24_ONE);
    reference->weakening = sum > 0 ? 0 : sum < low ? low : sum;
}

/*
 * Range: |i_d0| <= |i_q| <= 4, so lowest is -12 at the least and i_d0 + z within 16. k = 1 - s i_d/2 is 0.25
 * ... 6.5, for |s i_d| <= 11. torque/k is within 32. i_max^2 - i_d^2 <= 16; where a negative saliency made
 * i_d larger than i_max it is below 0, and its root 0.
 */
iqfoc_dq_t iqfoc_reference_step(iqfoc_reference_t *reference, const iqfoc_reference_config_t *config,
                                iq24_t torque, iqfoc_dq_t u, iq24_t u_limit)
{
    const iq24_t i_d0 = config->saliency == 0 ? 0 : most_torque_per_ampere(config->saliency, reference->i_q);
    const iq24_t room = iq24_min(config->i_d_min - i_d0, 0);
    weaken(reference, config->gain, voltage_left(u, iq24_mul_round(config->share, u_limit)),
           room - config->i_max);
    const iq24_t wanted = i_d0 + iq24_acc_round(reference->weakening);
    iqfoc_dq_t i = {iq24_max(wanted, config->i_d_min), torque};
    if (config->saliency != 0) {
        const iq24_t k = IQ24_ONE - iq24_asr32(iq24_mul_round(config->saliency, i.d), 1);
        i.q = iq24_div(torque, iq24_max(k, LEAST_TORQUE));
    }
    const iq24_acc_t rest = iq24_acc_mul(config->i_max, config->i_max) - iq24_acc_mul(i.d, i.d);
    const iq24_t most = iq24_max(iq24_sqrt(iq24_acc_round(rest)) + (wanted - i.d), 0);
    i.q = iq24_clamp(i.q, -most, most);
    reference->i_q = i.q;
    return i;
}

/* Range: squares within 2.85, so |g change| <= 183 and |z| <= 12: 2^56 in the accumulator. */
iq24_t iqfoc_reference_link(iqfoc_reference_t *reference, iqfoc_reference_link_t *link,
                            const iqfoc_reference_config_t *config, iqfoc_dq_t u, iq24_t u_limit)
{
    const iq24_t before = link->low;
    const bool lower = before == 0 || u_limit < before;
    const iq24_t low = lower ? u_limit : before + iq24_asr32(u_limit - before, LOW_RISES);
    link->low = low;
    if (before == 0) {
        return low;
    }
    const iq24_t u_before = iq24_mul_round(config->share, before);
    const iq24_t u_now = iq24_mul_round(config->share, low);
    const iq24_t left = voltage_left(u, u_now);
    const iq24_t change = iq24_mul_round(u_now, u_now) - iq24_mul_round(u_before, u_before);
    const iq24_t jump = change < 0 ? iq24_clamp(left, change, 0) : iq24_clamp(left, 0, change);
    const iq24_acc_t sum = iq24_acc_mac(reference->weakening, iq24_clamp(link->gain, 0, LINK_GAIN), jump);
    const iq24_acc_t least = iq24_acc_mul(Z_LOWEST, IQ24_ONE);
    reference->weakening = sum > 0 ? 0 : sum < least ? least : sum;
    return low;
}

/*
 * Clarke and Park transforms and their inverses: 2016 (2) and (3), amplitude invariant.
 *
 * All are inline, because a transform is shorter than its call, and may be called from any context. Phase and vector
 * components are IQ24 in per unit, within +-32 unless a function says otherwise: thirty times the rated current is
 * beyond any sensor. Outside that range the result wraps; it is never undefined. Errors are those of the function
 * alone, its inputs taken as exact.
 */
#ifndef IQFOC_TRANSFORM_H
#define IQFOC_TRANSFORM_H

#include "iq24_math.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Constants in Q31: with a 31-bit fraction their rounding costs at most |x| 2^-8 LSB, x in per unit. A
 * Q24 value times one of them is iq24_mul_shift(x, constant, 31), which cannot wrap: they are below 1.
 *
 * The transforms have the same product, to the bit, as a high word rounded to nearest: of x and twice the
 * constant, which for those of 1/2 and above is negative in 32 bits, so that x is to be added.
 */
#define IQFOC_Q31_1_SQRT3 INT32_C(1239850262) /* 1/sqrt(3) */
#define IQFOC_Q31_1_3     INT32_C(715827883)  /* 1/3 */
#define IQFOC_Q31_SQRT3_2 INT32_C(1859775393) /* sqrt(3)/2 */

static inline iq24_t iqfoc_third(iq24_t x)
{
    return iq24_mul_high_round(x, 2 * IQFOC_Q31_1_3);
}

static inline iq24_t iqfoc_over_sqrt3(iq24_t x)
{
    return iq24_add_wrap(x, iq24_mul_high_round(x, -INT32_C(1815266772))); /* 2 Q31_1_SQRT3 - 2^32 */
}

static inline iq24_t iqfoc_half_sqrt3(iq24_t x)
{
    return iq24_add_wrap(x, iq24_mul_high_round(x, -INT32_C(575416510))); /* 2 Q31_SQRT3_2 - 2^32 */
}

/*
 * Clarke transform from two phase currents of a floating star point (c = -a - b).
 *
 *     alpha = a,   beta = (a + 2 b)/sqrt(3)
 *
 * In: per unit, |a|, |b| <= 32. Out: |beta| <= 55.5. Largest error: alpha exact, beta 0.7 LSB.
 *
 * Range: |a + 2 b| <= 96 < 128, so the sums do not wrap.
 */
static inline iqfoc_ab_t iqfoc_clarke2(iq24_t a, iq24_t b)
{
    const iqfoc_ab_t ab = {a, iqfoc_over_sqrt3(iq24_add_wrap(a, iq24_add_wrap(b, b)))};
    return ab;
}

/*
 * Clarke transform from three phase currents; their zero sequence drops out.
 *
 *     alpha = (2 a - b - c)/3,   beta = (b - c)/sqrt(3)
 *
 * In: per unit, |a|, |b|, |c| <= 31.9. Out: |alpha| <= 42.6, |beta| <= 36.9. Largest error: 0.7 LSB each.
 *
 * Range: |2 a - b - c| <= 127.6 < 128.
 */
static inline iqfoc_ab_t iqfoc_clarke3(iqfoc_abc_t abc)
{
    const iq24_t two_a = iq24_add_wrap(abc.a, abc.a);
    const iq24_t b_and_c = iq24_add_wrap(abc.b, abc.c);
    const iqfoc_ab_t ab = {iqfoc_third(iq24_sub_wrap(two_a, b_and_c)),
                           iqfoc_over_sqrt3(iq24_sub_wrap(abc.b, abc.c))};
    return ab;
}

/*
 * Inverse Clarke transform: the phase values of a vector, without zero sequence.
 *
 *     a = alpha,   b = -alpha/2 + sqrt(3)/2 beta,   c = -alpha/2 - sqrt(3)/2 beta
 *
 * In: per unit, |alpha|, |beta| <= 64. Out: |b|, |c| <= 87.5. a + b + c = 0 exactly. Largest error: a exact,
 * b and c 1.2 LSB.
 *
 * Range: alpha/2 is floored (0.5 LSB); |alpha/2| + 0.867 |beta| <= 32 + 55.5 < 128. c = -(a + b) is formed
 * from the rounded b, so that the sum vanishes; |a + b| <= 87.5 < 128.
 */
static inline iqfoc_abc_t iqfoc_clarke_inverse(iqfoc_ab_t ab)
{
    const iq24_t b = iq24_sub_wrap(iqfoc_half_sqrt3(ab.beta), iq24_asr32(ab.alpha, 1));
    const iqfoc_abc_t abc = {ab.alpha, b, iq24_sub_wrap(0, iq24_add_wrap(ab.alpha, b))};
    return abc;
}

/*
 * Park transform: 2016 (3). x_dq = x_ab e^(-j theta), with sin and cos of theta given.
 *
 *     d = cos alpha + sin beta,   q = cos beta - sin alpha
 *
 * In: per unit, |alpha|, |beta| <= 64; |sin|, |cos| <= 1. Out: |d|, |q| <= 90.6. Largest error: 0.5 LSB.
 *
 * Range: each product is at most 2^30 2^24 = 2^54 and their sum 2^55, within int64; the sum / 2^24 is at most
 * 64 sqrt(2) = 90.6 in per unit for a true sine and cosine (sin^2 + cos^2 <= 1 + 2^-23), within iq24_t.
 */
static inline iqfoc_dq_t iqfoc_park(iqfoc_ab_t ab, iq24_sincos_t sc)
{
    const iq24_acc_t d = iq24_acc_mac(iq24_acc_mul(ab.alpha, sc.cos), ab.beta, sc.sin);
    const iq24_acc_t q = iq24_acc_mac(iq24_acc_mul(ab.beta, sc.cos), ab.alpha, -sc.sin);
    const iqfoc_dq_t dq = {iq24_acc_round(d), iq24_acc_round(q)};
    return dq;
}

/*
 * Inverse Park transform: x_ab = x_dq e^(j theta).
 *
 *     alpha = cos d - sin q,   beta = cos q + sin d
 *
 * Ranges and error as iqfoc_park.
 */
static inline iqfoc_ab_t iqfoc_park_inverse(iqfoc_dq_t dq, iq24_sincos_t sc)
{
    const iq24_acc_t alpha = iq24_acc_mac(iq24_acc_mul(dq.d, sc.cos), dq.q, -sc.sin);
    const iq24_acc_t beta = iq24_acc_mac(iq24_acc_mul(dq.q, sc.cos), dq.d, sc.sin);
    const iqfoc_ab_t ab = {iq24_acc_round(alpha), iq24_acc_round(beta)};
    return ab;
}

/*
 * The same by a sine and cosine in Q30 (iq24_sincos_q30_inline), rounded down: eight instructions less for a
 * voltage. |component| <= 64. Largest error: 1 LSB.
 *
 * Range: a product is at most 2^30 2^30 and their sum 2^61.
 */
static inline iqfoc_ab_t iqfoc_park_inverse_q30(iqfoc_dq_t dq, iq24_sincos_t sc_q30)
{
    const int64_t alpha = IQ24_MAC64(IQ24_MUL64(dq.d, sc_q30.cos), dq.q, -sc_q30.sin);
    const int64_t beta = IQ24_MAC64(IQ24_MUL64(dq.q, sc_q30.cos), dq.d, sc_q30.sin);
    const iqfoc_ab_t ab = {iq24_shift_wrap(alpha, 30), iq24_shift_wrap(beta, 30)};
    return ab;
}

/*
 * The same to the bit for |component| < 32: with four times the components the result is the high word of the sum, which
 * needs no shift.
 *
 * Range: 4 * 32 = 128 is beyond what iq24_t holds, below it fits; a product is below 2^61 and their sum below 2^62.
 */
static inline iqfoc_ab_t iqfoc_park_inverse_high(iqfoc_dq_t dq, iq24_sincos_t sc_q30)
{
    const int32_t d = iq24_wrap((int64_t)dq.d * 4);
    const int32_t q = iq24_wrap((int64_t)dq.q * 4);
    const iqfoc_ab_t ab = {iq24_high_of(IQ24_SUM64(d, sc_q30.cos, q, -sc_q30.sin)),
                           iq24_high_of(IQ24_SUM64(q, sc_q30.cos, d, sc_q30.sin))};
    return ab;
}

#ifdef __cplusplus
}
#endif

#endif

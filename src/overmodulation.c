/* Overmodulation up to six-step (include/iqfoc/overmodulation.h). */
#include "iqfoc/overmodulation.h"

#define PI_Q29     INT32_C(1686629713)
#define ONE_PI_Q31 INT32_C(683565276)

/* Width below the circle over which the length filter fades in, its gain, and its largest correction. */
#define FADE_WIDTH (IQ24_ONE / 8)
#define FOLLOW     3 /* 2^-3 of the difference a cycle */
#define DEVIATION  (IQ24_ONE / 16)

iqfoc_duties_t iqfoc_modulate_nearest(iqfoc_ab_t u, iq24_t u_dc_inverse)
{
    const iqfoc_ab_t v = {iq24_mul_trunc(u.alpha, u_dc_inverse), iq24_mul_trunc(u.beta, u_dc_inverse)};
    const iqfoc_abc_t x = iqfoc_clarke_inverse(v);
    const iq24_t span = iq24_sub_wrap(iq24_max(iq24_max(x.a, x.b), x.c), iq24_min(iq24_min(x.a, x.b), x.c));
    const iqfoc_duties_t duties = {iqfoc_overmodulation_legs(v),
                                   span > IQ24_ONE ? iqfoc_modulation_scale(span, IQ24_ONE) : IQ24_ONE};
    return duties;
}

iqfoc_ab_t iqfoc_modulated_voltage(iqfoc_abc_t high, iq24_t u_dc)
{
    const iqfoc_ab_t v = iqfoc_clarke3(high);
    const iqfoc_ab_t u = {iq24_mul_round(v.alpha, u_dc), iq24_mul_round(v.beta, u_dc)};
    return u;
}

iq24_t iqfoc_overmodulation_limit(const iqfoc_rotor_t *rotor)
{
    const iq24_t cosine = rotor->s1 - rotor->phi_s2; /* of phi/2 */
    const iq24_t sum = iq24_div(IQ24_ONE, rotor->s1) + cosine;
    return iq24_clamp(iq24_mul_shift(sum, ONE_PI_Q31, 31), IQFOC_OVERMODULATION_SIDES,
                      IQFOC_OVERMODULATION_MOST);
}

/*
 * U/M of the fundamental U = m: how much shorter the fundamental is than the vector that makes it.
 *
 * With y = sqrt(2 - pi m), which is near d/sqrt(3) close to six-step: from U(2/3) on y times a polynomial in
 * y^2, within 2e-8. Below it a polynomial in t = (y0 - y)/(y0 - y1), which is 0 at the circle and 1 at U(2/3),
 * with both ends exact; between them it costs the fundamental 1.3e-4 u_dc at most.
 *
 * Range: 0.5774 <= m <= 0.6365, so 5.7e-4 <= y^2 <= 0.1863 and 0.024 <= y <= 0.4316; the result is
 * 0.079 ... 1.
 */
static iq24_t shortness(iq24_t m)
{
    const iq24_t square = 2 * IQ24_ONE - iq24_mul_shift(m, PI_Q29, 29);
    const iq24_t y = iq24_sqrt(square);
    if (m >= IQFOC_OVERMODULATION_SIDES) {
        const iq24_t inner = IQ24(0.16263644) + iq24_mul_round(IQ24(-0.09006848), square);
        const iq24_t outer = IQ24(-2.39832634) + iq24_mul_round(inner, square);
        return iq24_mul_round(y, IQ24(3.30797368) + iq24_mul_round(outer, square));
    }
    const iq24_t t = iq24_clamp(iq24_mul_round(IQ24(0.431509717) - y, IQ24(7.302986654)), 0, IQ24_ONE);
    iq24_t bow = IQ24(0.18461749) + iq24_mul_round(IQ24(-0.24900165), t);
    bow = IQ24(-0.0775615) + iq24_mul_round(bow, t);
    bow = IQ24(-0.07625095) + iq24_mul_round(bow, t);
    bow = iq24_mul_round(bow, IQ24_ONE - t);
    return IQ24_ONE - iq24_mul_round(t, IQ24(0.086503328) + bow);
}

/*
 * The length to make: the requested length without its harmonics' part.
 *
 * Range: asked and slow are 0 ... 8, so their difference is within 8; weights are 0 ... 1; the correction is
 * within 1/16.
 */
static iq24_t steadied(iq24_t asked, iq24_t slow)
{
    const iq24_t circle = IQFOC_OVERMODULATION_CIRCLE;
    const iq24_t beyond = 32 * iq24_min(slow - circle, IQ24_ONE / 32);
    const iq24_t near = 8 * iq24_clamp(asked - (circle - FADE_WIDTH), 0, FADE_WIDTH);
    const iq24_t off = iq24_clamp(slow - asked, -IQ24_ONE, IQ24_ONE);
    return asked + iq24_clamp(iq24_mul_round(iq24_mul_round(beyond, near), off), -DEVIATION, DEVIATION);
}

/*
 * Range: beyond 8 the vector is divided by 8 and its length, for the sake of the square root, taken as 8:
 * |v| <= 64 leaves 1 ... 8. The vector made has a length of at most 8, U's inverse at its limit. factor is
 * made/|v|: where |v| is below circle - FADE_WIDTH = 0.45 it is 1, else at most 8/0.45 = 17.8.
 */
iqfoc_duties_t iqfoc_overmodulate_beyond(iqfoc_overmodulation_t *state, iqfoc_ab_t v, iq24_acc_t square,
                                         iq24_t limit)
{
    const bool far = square > INT64_C(64) * IQ24_ONE * IQ24_ONE;
    if (far) {
        v.alpha = iq24_asr32(v.alpha, 3);
        v.beta = iq24_asr32(v.beta, 3);
        square = iq24_acc_mac(iq24_acc_mul(v.alpha, v.alpha), v.beta, v.beta);
    }
    const iq24_t length = iq24_sqrt(iq24_acc_round(square));
    const iq24_t asked = far ? IQ24(8.0) : length;
    const iq24_t before = iq24_max(state->length, IQFOC_OVERMODULATION_CIRCLE);
    const iq24_t slow = before + iq24_asr32(iq24_max(asked, IQFOC_OVERMODULATION_CIRCLE) - before, FOLLOW);
    state->length = slow;
    const iq24_t m = iq24_min(steadied(asked, slow), limit);
    if (m != length || m > IQFOC_OVERMODULATION_CIRCLE) { /* never where the root of the square is coarse */
        const iq24_t shorter = m > IQFOC_OVERMODULATION_CIRCLE ? shortness(m) : IQ24_ONE;
        const iq24_t factor = iq24_div(m, iq24_mul_round(length, shorter));
        v.alpha = iq24_mul_round(v.alpha, factor);
        v.beta = iq24_mul_round(v.beta, factor);
    }
    const iq24_t allowed = limit + iq24_asr32(limit, 5);
    const iqfoc_duties_t duties = {iqfoc_overmodulation_legs(v),
                                   asked > allowed ? iqfoc_modulation_scale(asked, allowed) : IQ24_ONE};
    return duties;
}

/*
 * Overmodulation: three ways to limit a voltage vector beyond the hexagon of the inverter's states, up to six-step.
 *
 *     iqfoc_modulate              keeps the angle: smallest error of phase (modulation.h)
 *     iqfoc_modulate_nearest      the nearest point of the hexagon: smallest error of the vector
 *     iqfoc_overmodulate          the length that makes the requested fundamental, then the nearest point:
 *                                 smooth transition from linear modulation to six-step and back
 *
 * The nearest point on a side of the hexagon lowers the highest leg as much as it raises the lowest. Beyond the
 * side's ends the nearest point is a corner, where the vector is held. With duties counted from the middle between
 * highest and lowest leg, both mean: cut at 0 and at 1. A vector of length M (of the DC link) that turns at even
 * speed makes the fundamental
 *
 *     U(M) = M [1 - (3/pi)(d - sin(2 d)/2)],   cos d = 1/(sqrt(3) M)      1/sqrt(3) <= M <= 2/3
 *     U(M) = (d/sin d + cos d)/pi,             sin d = 1/(3 M)            2/3 <= M
 *
 * which tends to 2/pi, six-step, for large M. iqfoc_overmodulate inverts it, so that a controller's gain is 1
 * throughout. The vector is held at a corner except for 2 d in each sixth of a turn, in which one leg moves from one
 * end to the other. The leg may move within one control cycle, not faster. With sin d = sin(phi/2) the leg's duty in
 * that cycle is the mean of a six-step edge in it. The edge's volt-seconds are then right although the carrier is not
 * synchronous to the fundamental. That is the largest voltage, iqfoc_overmodulation_limit. A longer vector would put
 * each edge at the nearest valley, and its current would beat with the difference of both frequencies.
 *
 * There is no switching over and no hysteresis: each step depends continuously on the requested voltage.
 */
#ifndef IQFOC_OVERMODULATION_H
#define IQFOC_OVERMODULATION_H

#include "modulation.h"
#include "rotor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Lengths and fundamentals over the DC link. */
#define IQFOC_OVERMODULATION_CIRCLE                                                                          \
    INT32_C(9686330) /* 1/sqrt(3): a vector of this length is within the hexagon at every angle */
#define IQFOC_OVERMODULATION_SIDES                                                                           \
    INT32_C(10217287) /* U(2/3): a longer vector leaves the hexagon at every angle */
#define IQFOC_OVERMODULATION_MOST INT32_C(10677616) /* U(8): 0.9997 of six-step, the highest limit */

/*
 * The legs nearest to a voltage: its nearest point on the hexagon, or itself within it.
 *
 * v: voltage over u_dc, |v| <= 64. Duties lie in [0, 1]. Largest error 3 LSB.
 *
 * Range: phases <= 64.1; high - low <= 110.9 and half of 1 less it within 56, less low within 120: no sum
 * wraps. Error: as iqfoc_modulate within the hexagon.
 */
static inline iqfoc_abc_t iqfoc_overmodulation_legs(iqfoc_ab_t v)
{
    const iqfoc_abc_t x = iqfoc_clarke_inverse(v);
    const iq24_t low = iq24_min(iq24_min(x.a, x.b), x.c);
    const iq24_t high = iq24_max(iq24_max(x.a, x.b), x.c);
    const iq24_t shift = iq24_sub_wrap(iq24_asr32(iq24_sub_wrap(IQ24_ONE, iq24_sub_wrap(high, low)), 1), low);
    const iqfoc_abc_t legs = {iq24_clamp(iq24_add_wrap(x.a, shift), 0, IQ24_ONE),
                              iq24_clamp(iq24_add_wrap(x.b, shift), 0, IQ24_ONE),
                              iq24_clamp(iq24_add_wrap(x.c, shift), 0, IQ24_ONE)};
    return legs;
}

/*
 * Centre-aligned PWM that moves a voltage beyond the hexagon to its nearest point. For deadbeat control: its next
 * current is then as near to its target as possible. No state, no division except for scale. Any context.
 *
 * u: stationary voltage, per unit, |u| <= 32. u_dc_inverse: 0 < u_dc_inverse <= 2. Duties: iqfoc_modulate's,
 * bit by bit, within the hexagon; in [0, 1] for every input; largest error 3 LSB + 1 LSB per unit of
 * |u| u_dc_inverse. scale: as iqfoc_modulate's.
 */
iqfoc_duties_t iqfoc_modulate_nearest(iqfoc_ab_t u, iq24_t u_dc_inverse);

/* The mean voltage of a cycle with these duties, 0 ... 1, for u_dc, 0 ... 2: largest error 1.9 LSB. */
iqfoc_ab_t iqfoc_modulated_voltage(iqfoc_abc_t high, iq24_t u_dc);

/*
 * The largest fundamental over u_dc at a speed: U(M) with sin d = sin(phi/2), which is
 *
 *     (1/s1 + cos(phi/2))/pi
 *
 * held to U(2/3) ... U(8): IQFOC_OVERMODULATION_SIDES, where phi is beyond a sixth of a turn, to
 * IQFOC_OVERMODULATION_MOST below 1/75 of one. rotor: of the speed. Largest error 1.3 LSB.
 *
 * Range: 0.8269 <= s1 <= 1; the sum is 1.7 ... 2.
 */
iq24_t iqfoc_overmodulation_limit(const iqfoc_rotor_t *rotor);

/* The modulator's state; zero is the state after a time in the linear range. */
typedef struct iqfoc_overmodulation {
    iq24_t
        length; /* filtered length of the requested voltage over u_dc: moves by an eighth of the difference per cycle; see below */
} iqfoc_overmodulation_t;

/* The part of iqfoc_overmodulate for a voltage beyond the circle. v: |v| <= 64; square: |v|^2 in Q48. */
iqfoc_duties_t iqfoc_overmodulate_beyond(iqfoc_overmodulation_t *state, iqfoc_ab_t v, iq24_acc_t square,
                                         iq24_t limit);

/*
 * Centre-aligned PWM whose fundamental is the requested one, from 0 to six-step. From the interrupt that owns
 * `state`.
 *
 * u: stationary voltage, per unit, |u| <= 32. u_dc_inverse: 0 < u_dc_inverse <= 2. limit: what
 * iqfoc_overmodulation_limit gives, or less, down to IQFOC_OVERMODULATION_CIRCLE. Duties: within the circle those of
 * iqfoc_modulate, bit by bit; in [0, 1] for every input. Beyond it, after some cycles of constant length, the
 * fundamental is the requested one within 0.0003 u_dc. Largest error of a duty, of 400000 drawn: 20 LSB, and what 4
 * LSB of the length make of it.
 *
 * In overmodulation the current has harmonics of six times the fundamental, and a controller reacts to them. The
 * angle of its voltage is used unchanged. Its length is filtered by an eighth of the difference per cycle, so that
 * the harmonics do not reach the limit and cost voltage. The filter's effect grows from none at the circle to full
 * 1/32 beyond it. A difference of more than 1/16 of u_dc is not a harmonic, and its excess acts at once.
 * docs/run-up.md shows the result.
 *
 * scale: 1 while the requested voltage is at most 33/32 of the limit, else 33/32 limit over its length (over 8, if it
 * is longer). It is for the integrators' anti-windup: harmonics that just touch the limit must not change the
 * integrators.
 */
static inline iqfoc_duties_t iqfoc_overmodulate(iqfoc_overmodulation_t *state, iqfoc_ab_t u,
                                                iq24_t u_dc_inverse, iq24_t limit)
{
    const iqfoc_ab_t v = {iq24_mul_trunc(u.alpha, u_dc_inverse), iq24_mul_trunc(u.beta, u_dc_inverse)};
    /* |v| <= 64: the squares are within 2^60 each. */
    const iq24_acc_t square = iq24_acc_mac(iq24_acc_mul(v.alpha, v.alpha), v.beta, v.beta);
    if (square > INT64_C(93824992236885) || state->length > IQFOC_OVERMODULATION_CIRCLE) {
        return iqfoc_overmodulate_beyond(state, v, square, limit);
    }
    const iqfoc_duties_t duties = {iqfoc_overmodulation_legs(v), IQ24_ONE};
    return duties;
}

#ifdef __cplusplus
}
#endif

#endif

/*
 * Beyond the linear range: a voltage vector that the hexagon of the inverter's states has no room for, taken
 * to it in one of three ways, up to six-step.
 *
 *     iqfoc_modulate              keeps the angle: least error of phase (modulation.h)
 *     iqfoc_modulate_nearest      the nearest point of the hexagon: least error of the vector
 *     iqfoc_overmodulate          the length that makes the fundamental asked for, then the nearest point:
 *                                 a drive goes from linear modulation to six-step and back without a bump
 *
 * The nearest point of a hexagon's side is met by taking as much off the highest leg as is added to the
 * lowest; beyond the side's ends it is a corner, where the vector is held. With duties counted from the
 * middle between highest and lowest leg, all of that is: cut at 0 and at 1. A vector of length M (of the DC
 * link) that turns with even speed makes the fundamental
 *
 *     U(M) = M [1 - (3/pi)(d - sin(2 d)/2)],   cos d = 1/(sqrt(3) M)      1/sqrt(3) <= M <= 2/3
 *     U(M) = (d/sin d + cos d)/pi,             sin d = 1/(3 M)            2/3 <= M
 *
 * which is 2/pi, six-step, where M is without bound. iqfoc_overmodulate inverts it, so that a controller's
 * gain is 1 throughout. The vector is held at a corner but for 2 d in each sixth of a turn, in which one leg
 * moves from one end to the other. It may do so within one control cycle, not faster: with sin d = sin(phi/2)
 * the leg's duty in that cycle is the mean of a six-step edge that falls into it, so that the edge's
 * volt-seconds are right although the carrier knows nothing of the fundamental. That is the largest voltage,
 * iqfoc_overmodulation_limit. A vector without bound would put each edge at the nearest valley instead, and
 * its current would wander with the beat of both frequencies.
 *
 * There is no switching over and no hysteresis: each step depends continuously on what is asked for.
 */
#ifndef IQFOC_OVERMODULATION_H
#define IQFOC_OVERMODULATION_H

#include "modulation.h"
#include "rotor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Lengths and fundamentals over the DC link. */
#define IQFOC_OVERMODULATION_CIRCLE INT32_C(9686330)  /* 1/sqrt(3): within the hexagon at every angle */
#define IQFOC_OVERMODULATION_SIDES  INT32_C(10217287) /* U(2/3): from here on nothing is within it */
#define IQFOC_OVERMODULATION_MOST   INT32_C(10677616) /* U(8): 0.9997 of six-step, the highest limit */

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
 * Centre-aligned PWM that takes a voltage beyond the hexagon to its nearest point: what deadbeat control
 * wants, whose next current is then as near as it can be. No state, no division but for scale.
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

/* The modulator's memory; zeroed, it is as after a time in the linear range. */
typedef struct iqfoc_overmodulation {
    iq24_t length; /* of the voltage asked for over u_dc, followed by an eighth a cycle; see below */
} iqfoc_overmodulation_t;

/* The part of iqfoc_overmodulate for what is beyond the circle. v: |v| <= 64; square: |v|^2 in Q48. */
iqfoc_duties_t iqfoc_overmodulate_beyond(iqfoc_overmodulation_t *state, iqfoc_ab_t v, iq24_acc_t square,
                                         iq24_t limit);

/*
 * Centre-aligned PWM whose fundamental is what was asked for, from 0 to six-step.
 *
 * u: stationary voltage, per unit, |u| <= 32. u_dc_inverse: 0 < u_dc_inverse <= 2. limit: what
 * iqfoc_overmodulation_limit gives, or less, down to IQFOC_OVERMODULATION_CIRCLE. Duties: within the circle
 * those of iqfoc_modulate, bit by bit; in [0, 1] for every input. Beyond it, for a length that the voltage
 * has had for some cycles, the fundamental is the one asked for within 0.0003 u_dc. Largest error of a
 * duty, of 400000 drawn: 20 LSB, and what 4 LSB of the length make of it.
 *
 * In overmodulation the current has harmonics of six times the fundamental, and a controller answers them.
 * The angle of its voltage is taken as it is; its length is followed by an eighth of the difference a cycle,
 * so that the harmonics do not reach the limit and cost voltage. How much of that is done grows from none at
 * the circle to all of it 1/32 beyond; a difference of more than 1/16 of u_dc is no harmonic's, and what
 * there is more of it is taken at once. docs/run-up.md shows what comes of it.
 *
 * scale: 1 while the voltage asked for is at most 33/32 of the limit, else 33/32 limit over its length (over
 * 8, if it is longer), for the integrators' anti-windup: harmonics that just touch the limit shall not wind
 * anything back.
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

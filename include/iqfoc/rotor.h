/*
 * Rotor movement within one control cycle: the two functions that both papers use.
 *
 * With phi the electrical angle covered in one cycle,
 *
 *     s1(phi) = sin(phi/2) / (phi/2)                         even, 1 at standstill
 *     s2(phi) = (2 sin(phi/2) - phi cos(phi/2)) / phi^2      odd, phi/12 near standstill
 *
 * s1 is the factor on the mean of a stationary vector as seen from the turning rotor. s2 is the factor by which the
 * vector's change appears on the other axis. Both are polynomials in phi^2: no division, correct at standstill and in
 * reverse.
 *
 * The library's measure of speed is x = phi/(2 pi): IQ24, turns per control cycle. 1/x is the ratio of switching to
 * fundamental frequency (SFFR). Valid for |x| <= 1/3 (SFFR 3, phi = 2 pi/3); IQFOC_ROTOR_SPEED_MAX. All functions
 * only read their arguments: any context.
 */
#ifndef IQFOC_ROTOR_H
#define IQFOC_ROTOR_H

#include "iq24.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Largest |x| in turns per cycle: floor(2^24/3). The cycle holds the measured speed to it and sets
 * IQFOC_STATUS_OVERSPEED.
 */
#define IQFOC_ROTOR_SPEED_MAX INT32_C(5592405)

/* Values of one speed for the algorithms. Compute them when the speed changes, not in every cycle. */
typedef struct iqfoc_rotor {
    iq24_t speed;  /* x, turns per cycle */
    iq24_t phi;    /* 2 pi x, rad: -2.0944 ... 2.0944 */
    iq24_t s1;     /* 0.8269 ... 1 */
    iq24_t s2;     /* -0.1564 ... 0.1564 */
    iq24_t phi_s1; /* phi s1 = 2 sin(phi/2): -1.7321 ... 1.7321 */
    iq24_t phi_s2; /* phi s2 = s1 - cos(phi/2): 0 ... 0.3270 */
} iqfoc_rotor_t;

/*
 * The same before any rounding, for code that runs every cycle and needs only part of it: x in Q32, v = x^2
 * in Q32, and the polynomials P1 = s1 and P2 = s2/x in Q30.
 */
typedef struct {
    int32_t x_q32;
    int32_t v_q32;
    int32_t p1_q30;
    int32_t p2_q30;
} iqfoc_rotor_shape_t;

/* Coefficients of P1 and P2, a pair for each power, lowest first; src/rotor.c. */
extern const int32_t iqfoc_rotor_poly[5][2];

/* A step of Horner for both polynomials. */
static inline void iqfoc_rotor_horner(int32_t *p1, int32_t *p2, const int32_t *c, int32_t v)
{
    int32_t c1;
    int32_t c2;
    IQ24_LOAD_PAIR(c1, c2, c[0], c[1]);
    *p1 = iq24_mac_high(c1, *p1, v);
    *p2 = iq24_mac_high(c2, *p2, v);
}

/*
 * |speed| <= IQFOC_ROTOR_SPEED_MAX + 1. P1 lies in [0.826, 1], P2 in [0.469, 0.524]; errors are within those
 * of the functions that are made of them.
 *
 * Range: |256 x| <= 1431655936 < 2^31, so 0 <= v <= 2^32/9 < 2^29. A Horner step is c plus the high word of p
 * v, below 2^30 in size; the sums stay within Q30 (checked for every argument by the tests of the results).
 */
static inline iqfoc_rotor_shape_t iqfoc_rotor_shape(iq24_t speed)
{
    const int32_t(*c)[2] = iqfoc_rotor_poly;
    const int32_t x = speed * 256;
    const int32_t v = iq24_mul_high(x, x);
#ifdef IQFOC_ROTOR_POLYNOMIALS /* a target's own implementation, to the bit: P2 2^32 + P1 */
    const int64_t both = IQFOC_ROTOR_POLYNOMIALS(speed, &c[0][0]);
    const int32_t p1 = iq24_wrap(both);
    const int32_t p2 = iq24_wrap(iq24_asr64(both, 32));
#else
    int32_t p1;
    int32_t p2;
    IQ24_LOAD_PAIR(p1, p2, c[4][0], c[4][1]);
    iqfoc_rotor_horner(&p1, &p2, c[3], v);
    iqfoc_rotor_horner(&p1, &p2, c[2], v);
    iqfoc_rotor_horner(&p1, &p2, c[1], v);
    iqfoc_rotor_horner(&p1, &p2, c[0], v);
#endif
    const iqfoc_rotor_shape_t shape = {x, v, p1, p2};
    return shape;
}

/* s1 and s2 of a shape: 0.51 LSB. Range: P1 + 32 < 2^31. x P2 is floored in Q30, then rounded: once in all. */
static inline iq24_t iqfoc_rotor_s1(const iqfoc_rotor_shape_t *shape)
{
    return iq24_asr32(shape->p1_q30 + 32, 6);
}

static inline iq24_t iqfoc_rotor_s2(const iqfoc_rotor_shape_t *shape)
{
    return iq24_asr32(iq24_mul_high(shape->x_q32, shape->p2_q30) + 32, 6);
}

#define IQFOC_Q28_2_PI INT32_C(1686629713)

/*
 * The values for the algorithms from a shape with |speed| <= IQFOC_ROTOR_SPEED_MAX: iqfoc_rotor_from_speed for a
 * shape that is already computed.
 *
 * Range: P1 in Q30 lies in [0.826, 1] and P2 in [0.469, 0.524]. 2 pi P1 and 2 pi P2 are at most 6.284 in Q28, 2^30.7;
 * |x| <= 2^22.5, so that x times either is below 2^54. |phi| <= 2.1, |phi s1| <= 1.74, v 2 pi P2 <= 0.33. Error:
 * phi_s1 and phi_s2 contain the rounding of P1 2 pi and P2 2 pi, 2^-28 times x or v, and the polynomials' error. phi:
 * the floor of a floor is the floor of the whole, so it is rounded once.
 */
static inline iqfoc_rotor_t iqfoc_rotor_of_shape(iq24_t speed, const iqfoc_rotor_shape_t *shape)
{
    const int32_t two_pi_p1 = iq24_shift_wrap(IQ24_MUL64(shape->p1_q30, IQFOC_Q28_2_PI), 30);
    const int32_t two_pi_p2 = iq24_shift_wrap(IQ24_MUL64(shape->p2_q30, IQFOC_Q28_2_PI), 30);
    const iqfoc_rotor_t rotor = {speed,
                                 iq24_asr32(iq24_mul_high(shape->x_q32, IQFOC_Q28_2_PI) + 8, 4),
                                 iqfoc_rotor_s1(shape),
                                 iqfoc_rotor_s2(shape),
                                 iq24_mul_shift(speed, two_pi_p1, 28),
                                 iq24_asr32(iq24_mul_high(shape->v_q32, two_pi_p2) + 8, 4)};
    return rotor;
}

/*
 * s1 and s2 of a speed, and their products with phi.
 *
 * speed: IQ24 turns per control cycle, |speed| <= IQFOC_ROTOR_SPEED_MAX; a larger one is taken as that limit.
 * Largest error (all 11 184 811 arguments, tests/unit/library/test_rotor.c): s1, s2 0.51 LSB, phi 0.51 LSB, phi_s1
 * 0.55 LSB, phi_s2 0.6 LSB. Odd ones: f(-x) = -f(x) to 1 LSB. To the bit: s1 and s2/x are polynomials in x^2
 * through the functions at the Chebyshev nodes (tools/derive_rotor.py), products in between are rounded down and
 * each result once to nearest; likewise the steady state's gain below.
 */
iqfoc_rotor_t iqfoc_rotor_from_speed(iq24_t speed);

/*
 * The steady state's gain, s1 + 2 tan(phi/2) s2 = sin(h) tan(h)/h^2 with h = phi/2: 2016 (9) for any phi.
 * 1.0530 at phi = pi/3 (six-step), 1 at standstill, 1.3677 at the limit.
 *
 * speed: as above, same limit. Largest error (all arguments): 0.8 LSB.
 */
iq24_t iqfoc_rotor_steady_gain(iq24_t speed);

/*
 * An angle in Q32 turns, `instant` cycles later, -8 ... 8, at a speed in Q32 turns per cycle within +-1/3: IQ24 turns, -1/2 <= theta <
 * 1/2, rounded down. Range: |turns at| <= 8/3 turns is 2^33.5 in Q32; the sum wraps by whole turns. Any context.
 */
static inline iq24_t iqfoc_rotor_theta_of_q32(int32_t theta_q32, int32_t speed_q32, iq24_t instant)
{
    const int64_t moved = iq24_asr64(IQ24_MUL64(speed_q32, instant), 24);
    return iq24_asr32(iq24_wrap(theta_q32 + moved), 8);
}

/* A speed in Q32 turns per cycle within +-1/3, to the nearest IQ24. Any context. */
static inline iq24_t iqfoc_rotor_speed_of_q32(int32_t speed_q32)
{
    return iq24_asr32(speed_q32 + 128, 8);
}

/* Deprecated names of version 0.1. The next version has only the names above. */
#define iqfoc_rotor_from_turns iqfoc_rotor_from_speed
#define IQFOC_ROTOR_TURNS_MAX  IQFOC_ROTOR_SPEED_MAX

#ifdef __cplusplus
}
#endif

#endif

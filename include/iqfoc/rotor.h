/*
 * Rotor movement within one control cycle: the two functions that serve both papers.
 *
 * With phi the electrical angle covered in one cycle,
 *
 *     s1(phi) = sin(phi/2) / (phi/2)                         even, 1 at standstill
 *     s2(phi) = (2 sin(phi/2) - phi cos(phi/2)) / phi^2      odd, phi/12 near standstill
 *
 * s1 is how much of a stationary vector's length is left of its mean as seen from the turning rotor, s2 how
 * much of its change leaks across. Both are polynomials in phi^2: no division, right at standstill and in
 * reverse.
 *
 * The library's measure of speed is x = phi/(2 pi): IQ24, turns per control cycle. 1/x is the ratio of
 * switching to fundamental frequency (SFFR). Valid for |x| <= 1/3 (SFFR 3, phi = 2 pi/3);
 * IQFOC_ROTOR_TURNS_MAX.
 */
#ifndef IQFOC_ROTOR_H
#define IQFOC_ROTOR_H

#include "iq24.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Largest |x| in turns per cycle: floor(2^24/3). The cycle holds the measured speed to it and says so. */
#define IQFOC_ROTOR_TURNS_MAX INT32_C(5592405)

/* What the algorithms need of the speed: made where the speed changes, which need not be every cycle. */
typedef struct iqfoc_rotor {
    iq24_t turns;  /* x, turns per cycle */
    iq24_t phi;    /* 2 pi x, rad: -2.0944 ... 2.0944 */
    iq24_t s1;     /* 0.8269 ... 1 */
    iq24_t s2;     /* -0.1564 ... 0.1564 */
    iq24_t phi_s1; /* phi s1 = 2 sin(phi/2): -1.7321 ... 1.7321 */
    iq24_t phi_s2; /* phi s2 = s1 - cos(phi/2): 0 ... 0.3270 */
} iqfoc_rotor_t;

/*
 * s1 and s2 of a speed, and their products with phi.
 *
 * turns: IQ24 turns per control cycle, |turns| <= IQFOC_ROTOR_TURNS_MAX; a larger one is taken as that limit.
 * Largest error (all 11 184 811 arguments, tests/unit/test_rotor.c): s1, s2 0.51 LSB, phi 0.51 LSB, phi_s1
 * 0.55 LSB, phi_s2 0.6 LSB. Odd ones: f(-x) = -f(x) to 1 LSB.
 */
iqfoc_rotor_t iqfoc_rotor_from_turns(iq24_t turns);

/*
 * The steady state's gain, s1 + 2 tan(phi/2) s2 = sin(h) tan(h)/h^2 with h = phi/2: 2016 (9) for any phi.
 * 1.0530 at phi = pi/3 (six-step), 1 at standstill, 1.3677 at the limit.
 *
 * turns: as above, same limit. Largest error (all arguments): 0.8 LSB.
 */
iq24_t iqfoc_rotor_steady_gain(iq24_t turns);

#ifdef __cplusplus
}
#endif

#endif

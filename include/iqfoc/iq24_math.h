/*
 * Divide, square root, sine with cosine, and atan2 on IQ24 (numbers: iq24.h). All are pure functions.
 *
 * 1 LSB = 2^-24. Errors are against the exact function of the integer arguments; each says how it was found.
 * tests/unit/library/test_iq24_math.c enforces every sentence below.
 *
 * Instructions are those of a call on a Cortex-M4, entry through return, gcc 12.2 -O2 with the target header in
 * port/cortex-m4; they do not depend on the arguments but as stated. All but the sine use the core's unsigned 32-bit
 * divide, whose cycles (2 to 12 there) depend on them. On a core without a divide instruction, each divide is a
 * library call.
 */
#ifndef IQFOC_IQ24_MATH_H
#define IQFOC_IQ24_MATH_H

#include "iq24.h"
#include "iq24_sincos.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * sin(2 pi turns) and cos(2 pi turns), by rotating a tabulated angle (64 to the turn) through what remains.
 *
 * Scaling and overflow: any argument is an angle; whole turns (all but the low 24 bits) drop out. No output
 * can overflow.
 * Error: 0.51 LSB at most, over all 2^24 angles (0.50986 found, at 10091565). Exact at quarter turns.
 * Instructions: 28. iq24_sincos.h has the same function inline.
 */
iq24_sincos_t iq24_sincos(iq24_t turns);

/*
 * The angle of the vector (x, y) in turns, -0.5 <= angle < 0.5: the negative x axis gives -0.5.
 *
 * Scaling and overflow: x and y in any scale, the same for both; every pair is valid, IQ24_MIN included.
 * iq24_atan2(0, 0) = 0.
 * Error: 0.64 LSB at most, by analysis 0.5 (rounding) + 0.08 (ratio) + 0.06 (cubic and truncations); 0.6342
 * found over 16 million vectors drawn, on circles of all radii and at random. Exact on the axes and
 * diagonals, exactly odd in y (but for the half turn) and mirrored in x.
 * Instructions: 60; 12 for (0, 0).
 */
iq24_t iq24_atan2(iq24_t y, iq24_t x);

/*
 * sqrt(x), by two of Heron's steps on the 32 leading bits and one first-order correction; 0 for x <= 0.
 *
 * Scaling and overflow: the result is at most sqrt(128) = 11.3 and cannot overflow.
 * Error: 0.63 LSB at most, and 0.57 below 64.0 (0.6250 and 0.5625 found over 22 million arguments). Exact
 * where the root is an iq24_t.
 * Instructions: 41; 4 for x <= 0.
 */
iq24_t iq24_sqrt(iq24_t x);

/*
 * a / b to nearest, ties away from zero, by long division with 32-bit remainders.
 *
 * Scaling: a and b in any scale, the same for both. Overflow: saturates; a / 0 saturates by the sign of a,
 * and 0 / 0 = 0. Error: 0.5 LSB at most; it is the exact quotient, rounded once.
 */
iq24_t iq24_div(iq24_t a, iq24_t b);

#ifdef __cplusplus
}
#endif

#endif

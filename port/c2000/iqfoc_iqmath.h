/*
 * Between TI's IQmath and iqfoc: include it in a file that uses both.
 *
 * An _iq24 and an iq24_t are the same 32-bit number, integer / 2^24, so that values pass without a change. An
 * _iqN of another N is shifted. Angles per unit are turns in both; TI's atan2PU gives 0 ... 1, iq24_atan2
 * -0.5 ... 0.5. docs/from-iqmath.md has the table of functions.
 *
 * IQFOC_IQMATH_HEADER names another header for the type _iq24 than IQmathLib.h.
 */
#ifndef PORT_C2000_IQFOC_IQMATH_H
#define PORT_C2000_IQFOC_IQMATH_H

#include "iqfoc/iq24.h"

#ifdef IQFOC_IQMATH_HEADER
#include IQFOC_IQMATH_HEADER
#else
#include <IQmathLib.h>
#endif

/* _iq24 has 32 bits, as iq24_t has: an array of invalid size if not. */
typedef char iq24_assume_iq24_of_iqmath_has_32_bits[sizeof(_iq24) == sizeof(iq24_t) ? 1 : -1];

/* The same number. */
static inline iq24_t iqfoc_from_iq24(_iq24 x)
{
    return (iq24_t)x;
}

static inline _iq24 iqfoc_to_iq24(iq24_t x)
{
    return (_iq24)x;
}

/*
 * The number of an _iqN, x / 2^n, 1 <= n <= 30, in IQ24: saturates where it does not fit (n < 24), to
 * nearest, ties up, where bits are lost (n > 24). Error: 0.5 LSB at most. _iq is _iqN with n = GLOBAL_Q.
 */
static inline iq24_t iqfoc_from_iqn(int32_t x, uint32_t n)
{
    if (n <= 24) {
        return iq24_sat((int64_t)x * (INT64_C(1) << (24 - n)));
    }
    return iq24_wrap(iq24_asr64((int64_t)x + (INT64_C(1) << (n - 25)), n - 24));
}

/*
 * The number of an iq24_t as an _iqN: saturates for n > 24, to nearest, ties up, for n < 24. Error: half a
 * unit of _iqN at most.
 */
static inline int32_t iqfoc_to_iqn(iq24_t x, uint32_t n)
{
    if (n >= 24) {
        return iq24_sat((int64_t)x * (INT64_C(1) << (n - 24)));
    }
    return iq24_wrap(iq24_asr64((int64_t)x + (INT64_C(1) << (23 - n)), 24 - n));
}

/*
 * An angle in turns, any number, as IQmath's functions per unit give it: 0 <= angle < 1. The same angle,
 * exact.
 */
static inline _iq24 iqfoc_to_angle_pu(iq24_t turns)
{
    return (_iq24)(turns & (IQ24_ONE - 1));
}

/* An angle per unit of any whole turns in -0.5 <= turns < 0.5. The same angle, exact. */
static inline iq24_t iqfoc_from_angle_pu(_iq24 angle)
{
    const iq24_t turns = (iq24_t)angle & (IQ24_ONE - 1);
    return turns >= IQ24_ONE / 2 ? turns - IQ24_ONE : turns;
}

#endif

/* The difference of two angles. */
#ifndef IQFOC_SRC_ANGLE_H
#define IQFOC_SRC_ANGLE_H

#include "iqfoc/iq24.h"

/*
 * An angle, or a sum or difference of some, less its whole turns: -1/2 <= result < 1/2. Exact. Range: |x| <= 2^40; 2^32 is 256 turns, so that
 * whole turns drop out in the shift left, in 64 bits, and the wrap.
 */
static inline iq24_t angle_less_turns(int64_t x)
{
    return iq24_asr32(iq24_wrap(x * 256), 8);
}

#endif

/*
 * Long division n / d in base 256 for unsigned 32-bit n and d, with the 32-bit divide only. Private to src/.
 *
 * A step finds the next 8 bits of the quotient from the rest r: the digit is about 256 r / d, and 256 r may
 * need 39 bits. Where d < 2^24, r and d are scaled by 256 beforehand, and digit = r / (d / 256) is exact.
 * Where d >= 2^24, d / 256 is rounded up: the digit is then never too large and at most 1 too small, and the
 * next one takes up what is left.
 *
 * Range proof, d >= 2^24. trial = floor(d / 256) + 1, so d / 256 < trial <= d / 256 + 1. With
 * 0 <= r < 1.004 d:
 *
 *     digit = floor(r / trial) <= 256 r / d,  so that the new rest 256 r - digit d is not negative;
 *     digit > r / trial - 1,                  so that the new rest is below
 *                                             d + (r / trial) (256 trial - d) <= d + (256 r / d) 256
 *                                             < d + 1.004 * 65536 <= d (1 + 1.004 * 2^-8) < 1.004 d again.
 *
 * The rest stays below 1.004 * 2^31 < 2^32, and a digit is at most 1.004 * 256 < 258.
 *
 * d < 2^24, both scaled: r <= d < 2^32 and trial = d / 256, so that the new rest is below d and a digit at
 * most 256.
 */
#ifndef IQFOC_IQ24_LONGDIV_H
#define IQFOC_IQ24_LONGDIV_H

#include "iqfoc/iq24.h"

typedef struct {
    uint32_t quotient; /* digits so far */
    uint32_t rest;     /* what they leave: < 1.004 divisor */
    uint32_t divisor;  /* 2^8 ... 2^32 - 2^8, scaled as the rest is */
    uint32_t trial;    /* divisor / 256, rounded up where it is not exact */
} iq24_longdiv_t;

/* |x| as an unsigned number: 2^31 for the most negative one. ~x + 1 where x < 0, without a branch. */
static inline uint32_t iq24_magnitude(int32_t x)
{
    int32_t sign = iq24_asr32(x, 31); /* 0 or -1 */
    return (uint32_t)((int64_t)(x ^ sign) - sign);
}

/*
 * Preconditions: 1 <= divisor <= 2^31, rest <= divisor, quotient < 2^7. Three digits more leave the quotient
 * below 2^31 + 2^17.
 */
static inline iq24_longdiv_t iq24_longdiv_begin(uint32_t quotient, uint32_t rest, uint32_t divisor)
{
    uint32_t round_up = 1;
    if (divisor < (UINT32_C(1) << 24)) {
        divisor <<= 8;
        rest <<= 8;
        round_up = 0;
    }
    iq24_longdiv_t division = {quotient, rest, divisor, (divisor >> 8) + round_up};
    return division;
}

static inline void iq24_longdiv_step(iq24_longdiv_t *division)
{
    uint32_t digit = division->rest / division->trial;
    /* Written in 64 bits because 256 rest needs them; the difference does not, and is computed in 32. */
    division->rest = (uint32_t)(((uint64_t)division->rest << 8) - (uint64_t)digit * division->divisor);
    division->quotient = (division->quotient << 8) + digit;
}

#endif

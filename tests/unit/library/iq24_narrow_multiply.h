/*
 * A target header as a port to a core without a 32 x 32 -> 64 multiplication would write it: the product from
 * four 16-bit ones. The tests of IQ24 run a second time with it, and every result must be the same.
 */
#ifndef IQ24_NARROW_MULTIPLY_H
#define IQ24_NARROW_MULTIPLY_H

#include <stdint.h>

/*
 * Range: each factor is a 2^16 + b with |a| <= 2^15 and 0 <= b < 2^16. a_high b_high <= 2^30, each cross
 * product is below 2^31 in magnitude and their sum below 2^32, low below 2^32: all exact in 64 bits.
 */
static inline int64_t narrow_multiply(int32_t a, int32_t b)
{
    int32_t a_low = a & INT32_C(0xFFFF);
    int32_t b_low = b & INT32_C(0xFFFF);
    int32_t a_high = (a - a_low) / INT32_C(0x10000);
    int32_t b_high = (b - b_low) / INT32_C(0x10000);
    int64_t cross = (int64_t)(a_high * b_low) + a_low * b_high;
    uint32_t low = (uint32_t)a_low * (uint32_t)b_low;
    return (int64_t)(a_high * b_high) * INT64_C(0x100000000) + cross * INT64_C(0x10000) + low;
}

#define IQ24_MUL64(a, b) narrow_multiply((a), (b))

#endif

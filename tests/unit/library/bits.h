/*
 * Fixed-point arithmetic by division that rounds down: an independent reference for tests to the last bit. Exact in
 * 64 bits wherever the library's own products are.
 */
#ifndef TESTS_UNIT_BITS_H
#define TESTS_UNIT_BITS_H

#include "iqfoc/vector.h"
#include "reference.h"

/* floor(x / by), by > 0. */
static inline int64_t bits_floor(int64_t x, int64_t by)
{
    return x / by - (x % by < 0 ? 1 : 0);
}

/* x / 2^bits to nearest, ties up. */
static inline int64_t bits_nearest(int64_t x, int bits)
{
    const int64_t unit = INT64_C(1) << bits;
    return bits_floor(x + unit / 2, unit);
}

/* A product of two numbers to nearest: IQ24 of IQ24, or of other formats by their bits. */
static inline int64_t bits_product(int64_t x, int64_t y)
{
    return bits_nearest(x * y, 24);
}

static inline int64_t bits_product_of(int64_t x, int64_t y, int bits)
{
    return bits_nearest(x * y, bits);
}

/* floor(x y / 2^32): the high word of a product. */
static inline int64_t bits_high(int64_t x, int64_t y)
{
    return bits_floor(x * y, INT64_C(1) << 32);
}

static inline int64_t bits_held(int64_t x, int64_t low, int64_t high)
{
    return x < low ? low : x > high ? high : x;
}

/* A quotient to nearest, ties away from zero, in IQ24; the divisor is not 0 and the quotient within IQ24. */
static inline int64_t bits_quotient(int64_t n, int64_t d)
{
    const int64_t size = 2 * (n < 0 ? -n : n) * IQ24_ONE;
    const int64_t by = d < 0 ? -d : d;
    const int64_t quotient = (size + by) / (2 * by);
    return (n < 0) != (d < 0) ? -quotient : quotient;
}

/* An integer in [low, high]. */
static inline int32_t bits_random(uint64_t *seed, int64_t low, int64_t high)
{
    const uint64_t span = (uint64_t)(high - low) + 1;
    return (int32_t)(low + (int64_t)(random_bits(seed) % span));
}

/* Within +- limit, small values more often than an even draw has them. */
static inline iq24_t bits_small(uint64_t *seed, iq24_t limit)
{
    const iq24_t even = bits_random(seed, -limit, limit);
    return even / (1 << bits_random(seed, 0, 12));
}

/* Drawn one after the other: the order does not depend on the compiler. */
static inline iqfoc_abc_t bits_small_abc(uint64_t *seed, iq24_t limit)
{
    iqfoc_abc_t x;
    x.a = bits_small(seed, limit);
    x.b = bits_small(seed, limit);
    x.c = bits_small(seed, limit);
    return x;
}

#endif

/*
 * IQmath's arithmetic for N = 24 as far as TI's guide (SPRC990) and the instructions (SPRU430) document it,
 * in exact integers; nothing here is from TI's code. A product is the 64-bit one of IMPYL and QMPYL, shifted
 * right: floor, the low 32 bits kept.
 */
#ifndef TESTS_TARGET_IQMATH_DOCUMENTED_H
#define TESTS_TARGET_IQMATH_DOCUMENTED_H

#include <stdint.h>

/* floor(x / 2^bits). */
static inline int64_t ti_floor(int64_t x, int bits)
{
    const int64_t unit = (int64_t)1 << bits;
    return x / unit - (x % unit < 0 ? 1 : 0);
}

static inline int32_t ti_low(int64_t x)
{
    const int64_t low = x & INT64_C(0xFFFFFFFF);
    return (int32_t)(low >= INT64_C(0x80000000) ? low - INT64_C(0x100000000) : low);
}

static inline int32_t ti_hold(int64_t x)
{
    return (int32_t)(x > INT32_MAX ? INT32_MAX : x < INT32_MIN ? INT32_MIN : x);
}

/* _IQ24mpy: neither rounding nor saturation. */
static inline int32_t ti_mpy(int32_t a, int32_t b)
{
    return ti_low(ti_floor((int64_t)a * b, 24));
}

/* _IQ24rmpy: rounds. The guide does not say how a tie is rounded; here up. */
static inline int32_t ti_rmpy(int32_t a, int32_t b)
{
    return ti_low(ti_floor((int64_t)a * b + (1 << 23), 24));
}

/* _IQ24rsmpy: rounds and saturates. */
static inline int32_t ti_rsmpy(int32_t a, int32_t b)
{
    return ti_hold(ti_floor((int64_t)a * b + (1 << 23), 24));
}

/* _IQ24mpyIQX(a, n1, b, n2). */
static inline int32_t ti_mpy_iqx(int32_t a, int n1, int32_t b, int n2)
{
    return ti_low(ti_floor((int64_t)a * b, n1 + n2 - 24));
}

/* _IQ24(x): a cast, which cuts towards 0. */
static inline int32_t ti_constant(double x)
{
    return (int32_t)(x * 16777216.0);
}

/* _IQsat(x, most, least). */
static inline int32_t ti_sat(int32_t x, int32_t most, int32_t least)
{
    return x > most ? most : x < least ? least : x;
}

/* _IQdiv2, _IQdiv4, ...: shifts to the right. */
static inline int32_t ti_div_power(int32_t x, int bits)
{
    return (int32_t)ti_floor(x, bits);
}

/* _IQ24mpyI32: an integer factor. */
static inline int32_t ti_mpy_i32(int32_t x, int32_t k)
{
    return ti_low((int64_t)x * k);
}

#endif

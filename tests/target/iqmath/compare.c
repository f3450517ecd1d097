/*
 * IQmath by its documents against iqfoc (compare.h).
 */
#include "compare.h"

#include "documented.h"

#include "iqfoc/iq24.h"

/* All 32-bit patterns in an order of their own: xorshift, period 2^32 - 1. */
static uint32_t seed;

static int32_t drawn(void)
{
    seed ^= seed << 13 & UINT32_MAX;
    seed ^= seed >> 17;
    seed ^= seed << 5 & UINT32_MAX;
    /* Magnitudes of all sizes: per-unit values are small. */
    return iq24_asr32(iq24_from_bits(seed), seed >> 7 & 15);
}

#define EXTREMES 41
static int32_t extreme(int k)
{
    static const int32_t values[7] = {0,         IQ24_MIN,     IQ24_MAX,     IQ24_ONE,
                                      -IQ24_ONE, IQ24_ONE / 2, -IQ24_ONE / 2};
    if (k < 7) {
        return values[k];
    }
    const int32_t near = (k & 1) != 0 ? 1 : -1; /* 2^m +- 1, both signs */
    const int32_t power = INT32_C(1) << (k - 7) / 2 * 30 / 17;
    return (k & 2) != 0 ? power + near : -power - near;
}

/* The two results of row k. */
static void both(int k, int32_t a, int32_t b, int32_t result[2])
{
    const int32_t least = iq24_min(a, b);
    const int32_t most = iq24_max(a, b);
    switch (k) {
    case 0:
        result[0] = ti_mpy(a, b);
        result[1] = iq24_mul_trunc(a, b);
        break;
    case 1:
        result[0] = ti_rmpy(a, b);
        result[1] = iq24_mul_round(a, b);
        break;
    case 2:
        result[0] = ti_rsmpy(a, b);
        result[1] = iq24_mul_sat(a, b);
        break;
    case 3:
        result[0] = ti_mpy(a, b);
        result[1] = iq24_mul_round(a, b);
        break;
    case 4:
        result[0] = ti_mpy_iqx(a, 24, b, 30);
        result[1] = iq24_mul_shift(a, b, 30);
        break;
    case 5:
        result[0] = ti_constant(a / 33554432.0); /* at every half LSB */
        result[1] = IQ24(a / 33554432.0);
        break;
    case 6:
        result[0] = ti_sat(a, most / 2, least / 2);
        result[1] = iq24_clamp(a, least / 2, most / 2);
        break;
    case 7:
        result[0] = ti_div_power(a, 3);
        result[1] = iq24_asr32(a, 3);
        break;
    default:
        result[0] = ti_mpy_i32(a, b);
        result[1] = iq24_wrap((int64_t)a * b);
        break;
    }
}

/* Modulo 2^32: results that wrap may lie on both sides of an end. */
static int32_t difference(const int32_t result[2])
{
    return iq24_abs_sat(iq24_sub_wrap(result[1], result[0]));
}

void iqmath_compare(iqmath_row_t rows[IQMATH_ROWS], uint32_t draws)
{
    static const iqmath_row_t names[IQMATH_ROWS] = {
        {"`_IQ24mpy(a, b)`", "`iq24_mul_trunc(a, b)`", "both cut, both wrap", 0},
        {"`_IQ24rmpy(a, b)`", "`iq24_mul_round(a, b)`", "both round, both wrap; a tie: see below", 0},
        {"`_IQ24rsmpy(a, b)`", "`iq24_mul_sat(a, b)`", "both round, both saturate; a tie: see below", 0},
        {"`_IQ24mpy(a, b)`", "`iq24_mul_round(a, b)`", "iqfoc rounds", 0},
        {"`_IQ24mpyIQX(a, 24, b, 30)`", "`iq24_mul_shift(a, b, 30)`", "iqfoc rounds", 0},
        {"`_IQ24(x)`, a constant", "`IQ24(x)`", "iqfoc rounds, TI's cast cuts towards 0", 0},
        {"`_IQsat(x, max, min)`", "`iq24_clamp(x, min, max)`", "the order of the limits is another", 0},
        {"`_IQdiv8(x)`", "`iq24_asr32(x, 3)`", "both shift: floor", 0},
        {"`_IQ24mpyI32(x, k)`", "`iq24_wrap((int64_t)x * k)`", "both wrap", 0},
    };
    seed = 20190401;
    for (int k = 0; k < IQMATH_ROWS; k++) {
        int32_t result[2];
        rows[k] = names[k];
        for (int i = 0; i < EXTREMES * EXTREMES; i++) {
            both(k, extreme(i / EXTREMES), extreme(i % EXTREMES), result);
            rows[k].largest = iq24_max(rows[k].largest, difference(result));
        }
        for (uint32_t i = 0; i < draws; i++) {
            const int32_t a = drawn();
            both(k, a, drawn(), result);
            rows[k].largest = iq24_max(rows[k].largest, difference(result));
        }
    }
}

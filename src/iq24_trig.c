/*
 * Sine with cosine, and atan2, on IQ24; angles in turns.
 * Tables and coefficients: src/iq24_trig_tables.h, derived by tools/derive_iq24_trig.py.
 */
#include "iqfoc/iq24_math.h"

#include "iq24_longdiv.h"
#include "iq24_trig_tables.h"

/* floor(a b / 2^32): the high word of the product, one multiplication on a 32-bit core. */
static inline int32_t high_word(int32_t a, int32_t b)
{
    return iq24_wrap(iq24_asr64(IQ24_MUL64(a, b), 32)); /* |a b| <= 2^62: within 2^30 */
}

/*
 * With the angle split into a tabulated one (S, C its sine and cosine) and a rest d of at most half a cell:
 *     sin = S + C sin(d) - S (1 - cos(d)),    cos = C - S sin(d) - C (1 - cos(d)).
 */
iq24_sincos_t iq24_sincos(iq24_t turns)
{
    uint32_t angle = (uint32_t)turns & (uint32_t)(IQ24_ONE - 1);

    /* Nearest tabulated angle; 64 cells of 2^18. The sum is below 2^25, the index below 64 once cut to 6
     * bits. */
    uint32_t cell = ((angle + (UINT32_C(1) << 17)) >> 18) & (SINE_CELLS - 1);
    int32_t s = sine_q30[cell]; /* |s|, |c| <= 2^30 */
    int32_t c = sine_q30[cell + SINE_CELLS / 4];

    /* The low 18 bits as a signed number are the rest: e = 2^31 is half a cell. */
    int32_t e = iq24_wrap((int64_t)((angle & ((UINT32_C(1) << 18) - 1)) << 14));
    int32_t z = high_word(e, e); /* 0 <= z <= 2^30 */

    int32_t sin_d =
        high_word(e, ROTATE_S1 - high_word(z, ROTATE_S3)); /* Q34: |sin_d| < 0.0491 * 2^34 < 2^30 */
    int32_t minus_versin_d =
        high_word(z, high_word(z, ROTATE_C4) - ROTATE_C2); /* Q34: > -0.00121 * 2^34 > -2^25 */

    /* Q30 * Q34 = Q64, high word Q32. Each sum is below 2^30 (2^30 + 2^25), so its high word is below 2^29.
     */
    int32_t sin_change = iq24_wrap(iq24_asr64(IQ24_MUL64(c, sin_d) + IQ24_MUL64(s, minus_versin_d), 32));
    int32_t cos_change = iq24_wrap(iq24_asr64(IQ24_MUL64(s, -sin_d) + IQ24_MUL64(c, minus_versin_d), 32));

    /* Q30, at most 2^30 and the error; to nearest in Q24. */
    iq24_sincos_t result;
    result.sin = iq24_asr32(s + iq24_asr32(sin_change, 2) + 32, 6);
    result.cos = iq24_asr32(c + iq24_asr32(cos_change, 2) + 32, 6);
    return result;
}

iq24_t iq24_atan2(iq24_t y, iq24_t x)
{
    /* The first octant: ratio = low / high <= 1. */
    uint32_t x_size = iq24_magnitude(x);
    uint32_t y_size = iq24_magnitude(y);
    uint32_t high = x_size > y_size ? x_size : y_size;
    uint32_t low = x_size > y_size ? y_size : x_size;
    if (high == 0) {
        return 0;
    }
    iq24_longdiv_t division = iq24_longdiv_begin(0, low, high);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    uint32_t ratio = division.quotient; /* floor or one less, Q24: 0 ... 2^24 */

    /* The cubic around the nearest of 17 nodes, 2^20 apart. */
    const int32_t *cubic = arctan_q32[(ratio + (UINT32_C(1) << 19)) >> 20];
    int32_t u = iq24_wrap((int64_t)((ratio & ((UINT32_C(1) << 20) - 1)) << 12)); /* half a cell is 2^31 */
    int32_t slope = cubic[1] + high_word(u, cubic[2] + high_word(u, cubic[3]));
    int32_t angle = iq24_asr32(cubic[0] + high_word(u, slope) + 128, 8);

    /* 0 ... 1/8 turn; unfold to the half plane x, y >= 0 ... and the sign of y. Each step is exact. */
    angle = y_size > x_size ? IQ24_ONE / 4 - angle : angle;
    angle = x < 0 ? IQ24_ONE / 2 - angle : angle;
    angle = y < 0 ? -angle : angle;
    return iq24_asr32(iq24_wrap((int64_t)angle * 256), 8); /* 24 bits: +1/2 turn becomes -1/2 */
}

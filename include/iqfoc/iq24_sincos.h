/*
 * Sine with cosine for code that cannot afford the call: iq24_sincos of iq24_math.h is this function, once in
 * the library. Inlined, it costs a control loop some 10 instructions less than the call (Cortex-M4, gcc 12.2
 * -O2: no saved registers, no results through memory), and some 100 bytes of code for each use.
 */
#ifndef IQFOC_IQ24_SINCOS_H
#define IQFOC_IQ24_SINCOS_H

#include "iq24.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Q7.24 each, within -IQ24_ONE ... IQ24_ONE. */
typedef struct {
    iq24_t sin;
    iq24_t cos;
} iq24_sincos_t;

/*
 * sin(2 pi i / 64) in Q30, and a quarter turn more, so that the cosine is 16 entries on; behind them S1 + 1, -S3, -C2 and
 * C4 of the polynomials below, which the code loads by the table's address: iq24_trig.c.
 */
#define IQ24_SINE_CELLS 64
#define IQ24_SINE_TERMS (IQ24_SINE_CELLS + IQ24_SINE_CELLS / 4)
extern const int32_t iq24_sine_q30[IQ24_SINE_TERMS + 4];

/* Polynomials of sine and 1 - cosine up to half a cell: python3 tools/derive_iq24_trig.py --check */
#define IQ24_ROTATE_S1 INT32_C(1686629703)
#define IQ24_ROTATE_S3 INT32_C(2709043)
#define IQ24_ROTATE_C2 INT32_C(82792242)
#define IQ24_ROTATE_C4 INT32_C(66493)

/*
 * sin(2 pi turns) and cos(2 pi turns) in Q30, within 0.03 LSB of IQ24; rounded to IQ24 they are iq24_sincos of
 * iq24_math.h. The angle is a tabulated one, s and c its sine and cosine, and a rest d of at most half a cell
 * (0.0491 rad):
 *
 *     sin = s + c sin(d) - s (1 - cos(d)),    cos = c - s sin(d) - c (1 - cos(d))
 *
 * Range: |s|, |c| <= 2^30. |sin_d| < 0.0491 2^34 < 2^30 and 0 <= versin_d < 0.00121 2^34 < 2^25, both Q34.
 * Products are Q64, sums of two below 2^60 + 2^55; in Q30 the changes are below 2^27. s and c with their
 * changes are within 2^30 and an error of 2^4, so adding 2^5 cannot overflow; rounded, they are within 2^24.
 */
static inline iq24_sincos_t iq24_sincos_q30_inline(iq24_t turns)
{
    iq24_sincos_t result;
#ifdef IQ24_SINCOS_Q30 /* a target's own way: cosine in the high word, sine in the low one; to the bit but for port/c2000/iqfoc_tmu.h */
    const int64_t both = IQ24_SINCOS_Q30(turns);
    result.sin = iq24_wrap(both);
    result.cos = iq24_wrap(iq24_asr64(both, 32));
#else
    /* The nearest tabulated angle (cells are 2^18 wide), modulo one turn. */
    uint32_t cell = (uint32_t)iq24_asr32(iq24_add_wrap(turns, INT32_C(1) << 17), 18) % IQ24_SINE_CELLS;
    const int32_t *entry = &iq24_sine_q30[cell];
    int32_t s = entry[0];
    int32_t c = entry[IQ24_SINE_CELLS / 4];

    /* The rest: the low 18 bits as a signed number, scaled so that half a cell is 2^31. Its square, 2^30. */
    int32_t rest = iq24_wrap((int64_t)turns * (INT32_C(1) << 14));
    int32_t square = iq24_mul_high(rest, rest);
    const int32_t *const terms = &iq24_sine_q30[IQ24_SINE_TERMS];
    int32_t s1;
    int32_t s3;
    IQ24_LOAD_PAIR(s1, s3, terms[0], terms[1]);
    int32_t c2;
    int32_t c4;
    IQ24_LOAD_PAIR(c2, c4, terms[2], terms[3]);
    /* S1 - floor(square S3) is S1 + 1 + floor(-square S3), but for a square of 0, where one more changes no sin_d. */
    int32_t sin_d = iq24_mul_high(rest, IQ24_HIGH_PLUS(s1, square, s3));
    int32_t minus_versin_d = iq24_mul_high(square, IQ24_HIGH_PLUS(c2, square, c4));

    int64_t sin_change = IQ24_MAC64(IQ24_MUL64(c, sin_d), s, minus_versin_d);
    int64_t cos_change = IQ24_MAC64(IQ24_MUL64(s, -sin_d), c, minus_versin_d);

    result.sin = s + iq24_wrap(iq24_asr64(sin_change, 34));
    result.cos = c + iq24_wrap(iq24_asr64(cos_change, 34));
#endif
    return result;
}

/* The same rounded to IQ24. */
static inline iq24_sincos_t iq24_sincos_inline(iq24_t turns)
{
    const iq24_sincos_t q30 = iq24_sincos_q30_inline(turns);
    const iq24_sincos_t result = {iq24_asr32(q30.sin + 32, 6), iq24_asr32(q30.cos + 32, 6)};
    return result;
}

#ifdef __cplusplus
}
#endif

#endif

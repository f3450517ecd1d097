/*
 * An option for a C28x with FPU and TMU: sine, cosine and division by the TMU. Off by default. To use it:
 *
 *     --tmu_support=tmu0 --define=IQFOC_TARGET_HEADER='"iqfoc_tmu.h"'
 *
 * in place of iqfoc/target/c28x.h, which it includes. It is the only header of the library and its ports that
 * computes in floating point, next to iqfoc_si.h.
 *
 * Sine and cosine: not the bits of the plain library. The angle reaches the TMU exactly, and the result is
 * scaled by powers of two. Let e be the TMU's largest error in LSB of 2^-24. Then iq24_sincos is wrong by
 * e + 0.5 LSB at most, and iq24_sincos_q30_inline by e LSB + 1 unit of Q30. A correctly rounded float has
 * e = 0.5. No value of e was found in TI's documents: measure it on your chip over all 2^24 angles.
 * Results are within +-1.
 *
 * Division: the bits of the plain library, whatever the rounding mode of the FPU, if __divf32 is wrong by less
 * than 2^-19 of its result.
 *
 * Written after TI's manuals (SPRUHS1, SPRU514) and never run by this project, which has no such compiler.
 * tests/target/tmu checks it with models of the intrinsics.
 */
#ifndef PORT_C2000_IQFOC_TMU_H
#define PORT_C2000_IQFOC_TMU_H

#include "iqfoc/target/c28x.h"

#include <stdint.h>

/* A sine or cosine in Q30, held to +-1. */
static inline int32_t c2000_tmu_q30(float x)
{
    const float held = x > 1.0F ? 1.0F : x;
    return (int32_t)((held < -1.0F ? -1.0F : held) * 1073741824.0F);
}

/* The cosine is the high word, the sine the low one. The low 24 bits of the angle are a float without rounding. */
static inline int64_t c2000_tmu_sincos_q30(int32_t turns)
{
    const float angle = (float)((uint32_t)turns & UINT32_C(0xFFFFFF)) * (1.0F / 16777216.0F);
    const int64_t high = c2000_tmu_q30(__cospuf32(angle));
    return high * (INT64_C(1) << 32) + (int64_t)(uint32_t)c2000_tmu_q30(__sinpuf32(angle));
}

/* 2^24 (1 - 2^-18): a quotient computed with it is too small, by less than 2^-17 of itself, in every rounding mode. */
#define C2000_TMU_LOW 16777152.0F

/*
 * round(n 2^24 / d), ties up, for n / 128 < d and 1 <= d <= 2^31: a quotient from floats, its rest exactly, and
 * the rest's quotient from floats.
 *
 * Range: roundings to float take 2^-23 each at most, three of them and the TMU's 2^-19 less than 2^-18 in all.
 * So q <= n 2^24 / d < 2^31 and 0 <= rest < (2^14 + 1) d. If d < 2^17, rest < 2^32; else rest / 2^14 is, and
 * cutting 14 bits off the rest takes 2^14 / d <= 1/8 from its quotient. k is too small by less than
 * 1 + 2^14 2^-17 + 1/8 = 1.25, so last < 1.25 d: it rounds the quotient by 0 or 1.
 */
static inline uint32_t c2000_tmu_quotient(uint32_t n, uint32_t d)
{
    const float per_d = __divf32(C2000_TMU_LOW, (float)d);
    const uint32_t q = (uint32_t)((float)n * per_d);
    const uint64_t rest = (uint64_t)n * (UINT32_C(1) << 24) - (uint64_t)q * d;
    const uint32_t k = d < (UINT32_C(1) << 17)
                           ? (uint32_t)((float)(uint32_t)rest * (per_d * (1.0F / 16777216.0F)))
                           : (uint32_t)((float)(uint32_t)(rest >> 14) * (per_d * (1.0F / 1024.0F)));
    const uint32_t last = (uint32_t)rest - k * d;
    return q + k + (last >= d - (d >> 1) ? 1U : 0U);
}

#define IQ24_SINCOS_Q30(turns) c2000_tmu_sincos_q30(turns)
#define IQ24_QUOTIENT(n, d)    c2000_tmu_quotient(n, d)

#endif

/* Offset calibration of the current sensors (include/iqfoc/offset.h). */
#include "iqfoc/offset.h"

#include "root.h"

#include <stddef.h>

/* Deviations from the first sample are held to this, so that their squares can be summed. */
#define FAR IQ24(0.125)

iqfoc_error_t iqfoc_offset_init(iqfoc_offset_t *offset, const iqfoc_offset_limits_t *limits)
{
    if (offset == NULL || limits == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (limits->count_log2 < 2 || limits->count_log2 > 16 || !iq24_within(limits->offset_max, 1, IQ24_ONE) ||
        !iq24_within(limits->noise_max, 1, FAR)) {
        return IQFOC_ERROR_OFFSET_LIMITS;
    }
    const iqfoc_offset_t fresh = {limits,           IQFOC_OFFSET_BUSY, 0,
                                  {0, 0, 0},        {0, 0, 0},         0,
                                  {0, 0, 0, false}, {0, 0, 0, false},  {0, 0, 0, false}};
    *offset = fresh;
    return IQFOC_OK;
}

/* Range: |d| <= 2^21 and at most 2^16 samples: |sum| <= 2^37, squares <= 2^58. */
static void add(iqfoc_offset_sums_t *sums, iq24_t measured, bool first)
{
    const iqfoc_offset_sums_t begun = {measured, 0, 0, false};
    if (first) {
        *sums = begun;
    }
    const iq24_t d = iq24_sub_sat(measured, sums->first);
    const iq24_t held = iq24_clamp(d, -FAR, FAR);
    sums->far = sums->far || d != held;
    sums->sum += held;
    sums->squares = IQ24_MAC64(sums->squares, held, held);
}

/*
 * Offset and rms noise of one sensor. With m the rounded mean of the deviations, the sum of (d - m)^2 is
 * squares - 2 m sum + n m^2.
 *
 * Range: |m| <= 2^21, so that 2 m sum <= 2^59 and n m^2 <= 2^58: within int64. The result is a sum of
 * squares, not below 0, and its mean is at most (2^22)^2. m is within 0.5 of the mean, which adds at most
 * 0.25 LSB^2 to the variance: where that reaches the next whole number, the floored root is sqrt(1) -
 * sqrt(0.75) = 0.134 too large at most, else below 1 too small.
 */
static void evaluate(const iqfoc_offset_sums_t *sums, uint32_t count_log2, iq24_t *offset, iq24_t *noise)
{
    const int64_t n = INT64_C(1) << count_log2;
    const int64_t m = iq24_asr64(sums->sum + n / 2, count_log2);
    const int64_t spread = sums->squares - 2 * m * sums->sum + n * m * m;
    *offset = iq24_add_sat(sums->first, (iq24_t)m);
    *noise = sums->far ? FAR : root_of(iq24_asr64(spread, count_log2));
}

/* One bit for each sensor with a value above the limit. */
static uint32_t beyond(iqfoc_abc_t x, iq24_t limit)
{
    return (iq24_abs_sat(x.a) > limit ? UINT32_C(1) : 0) | (iq24_abs_sat(x.b) > limit ? UINT32_C(2) : 0) |
           (iq24_abs_sat(x.c) > limit ? UINT32_C(4) : 0);
}

static void conclude(iqfoc_offset_t *o)
{
    const uint32_t n = o->limits->count_log2;
    evaluate(&o->a, n, &o->offset.a, &o->noise.a);
    evaluate(&o->b, n, &o->offset.b, &o->noise.b);
    evaluate(&o->c, n, &o->offset.c, &o->noise.c);
    const uint32_t far =
        (o->a.far ? UINT32_C(1) : 0) | (o->b.far ? UINT32_C(2) : 0) | (o->c.far ? UINT32_C(4) : 0);
    const uint32_t shifted = beyond(o->offset, o->limits->offset_max);
    const uint32_t noisy = beyond(o->noise, o->limits->noise_max) | far;
    o->faulty = shifted != 0 ? shifted : noisy;
    o->verdict = shifted != 0 ? IQFOC_OFFSET_OUT_OF_RANGE
                 : noisy != 0 ? IQFOC_OFFSET_NOISY
                              : IQFOC_OFFSET_GOOD;
}

iqfoc_offset_verdict_t iqfoc_offset_step(iqfoc_offset_t *offset, iqfoc_abc_t measured)
{
    if (offset->verdict != IQFOC_OFFSET_BUSY) {
        return offset->verdict;
    }
    const uint32_t seen = offset->seen;
    offset->seen = seen + 1;
    if (seen < offset->limits->settle) {
        return offset->verdict;
    }
    const uint32_t counted = seen - offset->limits->settle;
    add(&offset->a, measured.a, counted == 0);
    add(&offset->b, measured.b, counted == 0);
    add(&offset->c, measured.c, counted == 0);
    if (counted + 1 == UINT32_C(1) << offset->limits->count_log2) {
        conclude(offset);
    }
    return offset->verdict;
}

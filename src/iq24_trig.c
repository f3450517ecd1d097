/*
 * Sine with cosine, and atan2, on IQ24; angles in turns.
 * Tables and coefficients: src/iq24_trig_tables.h, derived by tools/derive_iq24_trig.py.
 */
#include "iqfoc/iq24_math.h"

#include "angle.h"
#include "iq24_longdiv.h"
#include "iq24_trig_tables.h"

iq24_sincos_t iq24_sincos(iq24_t turns)
{
    return iq24_sincos_inline(turns);
}

/*
 * In the first octant atan(low / high), the ratio by long division, a cubic around the nearest of 17 nodes;
 * then unfolded by symmetry.
 *
 * Range: x_size, y_size <= 2^31; high >= 1 from the test on, and low <= high, as the division requires. Its
 * quotient is the ratio in Q24, floored or one less: 0 ... 2^24; the node 0 ... 16. The distance to the node,
 * half a cell being 2^31, is any int32_t. cubic[3] and cubic[2] are below 2^20, cubic[1] below 2^26 and
 * cubic[0] below 2^30, and a high word is at most half its coefficient: no sum reaches 2^31.
 * Unfolding: 0 <= angle <= 2^21; then 2^22, 2^23, +-2^23, each exactly. Kept to 24 bits, +2^23 is -2^23.
 */
iq24_t iq24_atan2(iq24_t y, iq24_t x)
{
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
    uint32_t ratio = division.quotient;
    /*@ assert longdiv: ratio <= 16777216; */

    /* Nodes are 2^20 apart: the low 20 bits, as a signed number, are the distance to the nearest. */
    const int32_t *cubic = arctan_q32[(ratio + (UINT32_C(1) << 19)) >> 20];
    int32_t rest = iq24_wrap((int64_t)ratio * (INT32_C(1) << 12));
    int32_t slope = cubic[1] + iq24_mul_high(rest, cubic[2] + iq24_mul_high(rest, cubic[3]));
    int32_t angle = iq24_asr32(cubic[0] + iq24_mul_high(rest, slope) + 128, 8); /* Q32 to Q24, rounded */

    angle = y_size > x_size ? IQ24_ONE / 4 - angle : angle;
    angle = x < 0 ? IQ24_ONE / 2 - angle : angle;
    angle = y < 0 ? -angle : angle;
    return angle_less_turns(angle);
}

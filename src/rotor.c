/* Rotor movement: polynomials for s1, s2 and the steady gain (include/iqfoc/rotor.h, docs/equations.md). */
#include "iqfoc/rotor.h"

/*
 * Polynomials of s1 and s2/x, Q30 in v = x^2; Chebyshev interpolation on v in [0, 1/9]: tools/derive_rotor.py, which
 * CI compares with these.
 */
const int32_t iqfoc_rotor_poly[5][2] = {{1073741824, 562209904},
                                        {-1766234468, -554878930},
                                        {871599137, 195586663},
                                        {-204751197, -35739408},
                                        {27384229, 3925530}};
/* Q27 in 4 v, same script. Its pole at v = 1/4 makes it longer. */
static const int32_t steady_gain_poly[10] = {134217727, 55195100,   70343732,  69768713,    61303921,
                                             132864674, -233076297, 925066755, -1289881809, 1055357834};

static iq24_t limited(iq24_t speed)
{
    return iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
}

iqfoc_rotor_t iqfoc_rotor_from_speed(iq24_t speed)
{
    const iq24_t x = limited(speed);
    const iqfoc_rotor_shape_t shape = iqfoc_rotor_shape(x);
    return iqfoc_rotor_of_shape(x, &shape);
}

/*
 * P3 in Q27 lies in [1, 1.368] at its end; the partial sums stay below 16 in size. 4 v <= 4/9 in Q32 is
 * 1908874352 < 2^31.
 */
iq24_t iqfoc_rotor_steady_gain(iq24_t speed)
{
    const int32_t x_q32 = limited(speed) * 256;
    const int32_t v4 = iq24_mul_high(x_q32, x_q32) * 4;
    int32_t p = steady_gain_poly[9];
    for (int32_t k = 8; k >= 0; k--) {
        p = iq24_mac_high(steady_gain_poly[k], p, v4);
    }
    return iq24_asr32(p + 4, 3);
}

/* Rotor movement: polynomials for s1, s2 and the steady gain (include/iqfoc/rotor.h, docs/equations.md). */
#include "iqfoc/rotor.h"

#include "angle.h"

/*
 * Q30 in v = x^2; Chebyshev interpolation on v in [0, 1/9]: tools/derive_rotor.py, which CI
 * compares with these.
 */
static const int32_t s1_poly[5] = {1073741824, -1766234468, 871599137, -204751197, 27384229};
static const int32_t s2_poly[5] = {562209904, -554878930, 195586663, -35739408, 3925530};
/* Q27 in 4 v, same script. Its pole at v = 1/4 makes it longer. */
static const int32_t steady_gain_poly[10] = {134217727, 55195100,   70343732,  69768713,    61303921,
                                             132864674, -233076297, 925066755, -1289881809, 1055357834};

/*
 * x^2 in Q32.
 *
 * Range: |x| <= 2^24/3 after the limit, so |256 x| <= 1431655680 < 2^31 and (256 x)^2 2^-32 <= 2^32/9 < 2^29.
 * Error: floor, 2^-32.
 */
static int32_t turns_squared_q32(iq24_t turns)
{
    const int32_t x_q32 = turns * 256;
    return iq24_mul_high(x_q32, x_q32);
}

/*
 * One Horner step: c + p v, the format of p and c kept; v in Q32.
 *
 * Range: |p| < 2^31 and 0 <= v < 2^31 give |p v| < 2^62; the high word is below 2^30, and the callers' sums
 * stay within their format (checked for every argument by the tests through the results' errors). Error:
 * floor, one unit of the format.
 */
static int32_t horner(int32_t p, int32_t v_q32, int32_t c)
{
    return iq24_add_wrap(c, iq24_mul_high(p, v_q32));
}

static iq24_t limited(iq24_t turns)
{
    return iq24_clamp(turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
}

/*
 * Range: P1 in Q30 lies in [0.826, 1], so P1 + 32 < 2^31. P2 in Q30 lies in [0.469, 0.524]. 2 pi P1 and
 * 2 pi P2 are at most 6.284 in Q28, 2^30.7; |x| <= 2^22.5, so that x times either is below 2^54. |phi| <= 2.1,
 * |phi s1| <= 1.74, v 2 pi P2 <= 0.33.
 * Error: phi_s1 and phi_s2 carry what the floors of P1 2 pi and P2 2 pi lose, 2^-28 times x or v, and the
 * polynomials'.
 */
iqfoc_rotor_t iqfoc_rotor_from_turns(iq24_t turns)
{
    const iq24_t x = limited(turns);
    const int32_t v = turns_squared_q32(x);
    int32_t p1 = s1_poly[4];
    int32_t p2 = s2_poly[4];
    p1 = horner(p1, v, s1_poly[3]);
    p2 = horner(p2, v, s2_poly[3]);
    p1 = horner(p1, v, s1_poly[2]);
    p2 = horner(p2, v, s2_poly[2]);
    p1 = horner(p1, v, s1_poly[1]);
    p2 = horner(p2, v, s2_poly[1]);
    p1 = horner(p1, v, s1_poly[0]);
    p2 = horner(p2, v, s2_poly[0]);
    const int32_t two_pi_p1 = iq24_shift_wrap(IQ24_MUL64(p1, TWO_PI_Q28), 30);
    const int32_t two_pi_p2 = iq24_shift_wrap(IQ24_MUL64(p2, TWO_PI_Q28), 30);
    const iqfoc_rotor_t rotor = {.turns = x,
                                 .phi = iq24_mul_shift(x, TWO_PI_Q28, 28),
                                 .s1 = iq24_asr32(p1 + 32, 6),
                                 .s2 = iq24_mul_shift(x, p2, 30),
                                 .phi_s1 = iq24_mul_shift(x, two_pi_p1, 28),
                                 .phi_s2 = iq24_asr32(iq24_mul_high(v, two_pi_p2) + 8, 4)};
    return rotor;
}

/*
 * P3 in Q27 lies in [1, 1.368] at its end; the partial sums stay below 16 in size. 4 v <= 4/9 in Q32 is
 * 1908874352 < 2^31.
 */
iq24_t iqfoc_rotor_steady_gain(iq24_t turns)
{
    const int32_t v4 = turns_squared_q32(limited(turns)) * 4;
    int32_t p = steady_gain_poly[9];
    for (int32_t k = 8; k >= 0; k--) {
        p = horner(p, v4, steady_gain_poly[k]);
    }
    return iq24_asr32(p + 4, 3);
}

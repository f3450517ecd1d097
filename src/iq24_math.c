/*
 * Divide and square root on IQ24: long division in base 256, and Heron's iteration s <- (s + m / s) / 2.
 * Both rest on the 32-bit unsigned divide, so that neither a 64-bit division nor a table is linked.
 */
#include "iqfoc/iq24_math.h"

#include "iq24_longdiv.h"

iq24_t iq24_div(iq24_t a, iq24_t b)
{
    uint32_t n = iq24_magnitude(a); /* 0 <= n, d <= 2^31 */
    uint32_t d = iq24_magnitude(b);
    int32_t sign = iq24_asr32(a ^ b, 31); /* 0 or -1 */

    /* |a / b| >= 128, or b = 0: the two are one condition, as n / 128 >= 0 always holds. */
    if ((n >> 7) >= d) {
        return n == 0 ? 0 : (IQ24_MAX ^ sign);
    }
    /* Now d >= 1 and n < 128 d. */
    iq24_longdiv_t division = iq24_longdiv_begin(n / d, n % d, d); /* quotient <= 127, rest < d */
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division); /* n 2^24 / d = quotient + rest / divisor, rest < 1.004 divisor */

    /* To nearest: up if rest >= divisor / 2, and one step up is always enough as rest < 1.5 divisor.
     * quotient <= 2^31 - 1: to round to 2^31 takes n / d >= 128 - 2^-25, hence d >= 2^25 with n >= 128 d - 1
     * > 2^31. */
    uint32_t half = division.divisor - (division.divisor >> 1); /* rounded up */
    uint32_t quotient = division.quotient + (division.rest >= half);
    return iq24_wrap(((int64_t)quotient ^ sign) - sign); /* -q = ~q + 1 */
}

iq24_t iq24_sqrt(iq24_t x)
{
    if (x <= 0) {
        return 0;
    }
    /* m = x 4^k with 2^30 <= m < 2^32. k = 0 ... 15, found by halving: after the first line m >= 2^16, then
     * 2^24, 2^28, 2^30. sqrt(x / 2^24) in units of 2^-24 is sqrt(x 2^24) = 2^12 sqrt(m) / 2^k. */
    uint32_t m = (uint32_t)x;
    uint32_t k = 0;
    if (m < (UINT32_C(1) << 16)) {
        m <<= 16;
        k = 8;
    }
    if (m < (UINT32_C(1) << 24)) {
        m <<= 8;
        k += 4;
    }
    if (m < (UINT32_C(1) << 28)) {
        m <<= 4;
        k += 2;
    }
    if (m < (UINT32_C(1) << 30)) {
        m <<= 2;
        k += 1;
    }

    /* A straight line (0.6875 + 0.34375 m / 2^30) 2^15 is within 3.2 % of sqrt(m): 2^15 < s < 1.04 * 2^16.
     * (m >> 15) < 2^17, times 11 < 2^21. */
    uint32_t s = 22528 + (((m >> 15) * 11) >> 5);
    /* Heron squares the relative error and halves it: 5.0e-4, then 1.3e-7 (0.01 of a unit of s, always
     * upwards); flooring twice takes less than one unit away, and never leads below floor(sqrt(m)). */
    s = (s + m / s) >> 1;
    s = (s + m / s) >> 1; /* floor(sqrt(m)) <= s < sqrt(m) + 0.01, 2^15 <= s <= 2^16 */

    /* sqrt(m) = s + r / 2s - r^2 / 8s^3 ..., r = m - s^2, -1400 < r <= 2s < 2^17. The quadratic term is below
     * 1 / 2s <= 2^-16. In units of 2^-15: root < 2^31 + 2^12, its error below 0.5 (that term) + 1 (the
     * division). */
    int32_t r = (int32_t)((int64_t)m - (int64_t)s * s);
    uint32_t root = (uint32_t)(((int64_t)s << 15) + r * 16384 / (int32_t)s);

    /* The result is root / 2^(3 + k), to nearest: below 2^28. */
    return iq24_wrap((int64_t)((root + (UINT32_C(4) << k)) >> (k + 3)));
}

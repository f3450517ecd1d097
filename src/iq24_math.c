/*
 * Divide and square root on IQ24: long division in base 256, and Heron's iteration s <- (s + m / s) / 2.
 * Both rest on the 32-bit unsigned divide, so that neither a 64-bit division nor a table is linked.
 */
#include "iqfoc/iq24_math.h"

#include "iq24_longdiv.h"

/*
 * n / d = |a / b| to nearest, and the sign.
 *
 * Range: 0 <= n, d <= 2^31. Saturation is one comparison: |a / b| >= 128 or b = 0 is n / 128 >= d, as
 * n / 128 >= 0 always holds. Past it d >= 1 and n < 128 d, so the integer part n / d is at most 127, as the
 * long division requires; three digits later n 2^24 / d = quotient + rest / divisor with rest < 1.004
 * divisor. Rounding up where rest >= divisor / 2 leaves at most half the divisor: one step is always enough.
 * quotient <= 2^31 - 1: to round to 2^31 would take n / d >= 128 - 2^-25 with n <= 128 d - 1, hence d >= 2^25
 * and n >= 128 d - 128 2^-32 d > 2^31.
 */
iq24_t iq24_div(iq24_t a, iq24_t b)
{
    uint32_t n = iq24_magnitude(a);
    uint32_t d = iq24_magnitude(b);
    int32_t sign = iq24_asr32(a ^ b, 31); /* 0 or -1 */
    if ((n >> 7) >= d) {
        return n == 0 ? 0 : (IQ24_MAX ^ sign); /* MAX ^ -1 = MIN */
    }
#ifdef IQ24_QUOTIENT /* a target's own way, to the bit: round(n 2^24 / d), ties up */
    const uint32_t quotient = IQ24_QUOTIENT(n, d);
#else
    iq24_longdiv_t division = iq24_longdiv_begin(n / d, n % d, d);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    iq24_longdiv_step(&division);
    uint32_t half = division.divisor - (division.divisor >> 1); /* rounded up */
    uint32_t quotient = division.quotient + (division.rest >= half);
#endif
    return iq24_wrap(((int64_t)quotient ^ sign) - sign); /* ~q + 1 = -q */
}

/*
 * With m = x 4^k, 2^30 <= m < 2^32, the root of x / 2^24 in units of 2^-24 is sqrt(x 2^24) = 2^12 sqrt(m) /
 * 2^k.
 *
 * Range: k = 0 ... 15 is found by halving; m >= 2^16, 2^24, 2^28 and 2^30 after each test.
 * The straight line is (0.6875 + 0.34375 m / 2^30) 2^15, within 3.2 % of sqrt(m); (m >> 15) 11 < 2^21.
 * A step of Heron's squares the relative error and halves it, always upwards: 5e-4, then 1.3e-7, 0.01 of a
 * unit of s. Its two floors take less than one unit away and never lead below floor(sqrt(m)):
 *     floor(sqrt(m)) <= s < sqrt(m) + 0.01, 2^15 <= s <= 2^16.
 * rest = m - s^2: from -1400 to 2 s, and s = 2^16 leaves rest < 0; so |rest| < 2^17, rest 2^14 < 2^31.
 * sqrt(m) = s + rest / 2s - rest^2 / 8s^3 + ...: the third term is below 1 / 2s <= 2^-16 (where rest > 0). In
 * units of 2^-15, leaving it out makes root at most 0.5 too large; the division, 1 too small or, where
 * rest < 0, 1 too large. An LSB is 8 2^k such units: 0.5 + 1/8 LSB in all. root < 2^31 + 2, the sum below
 * 2^32.
 */
iq24_t iq24_sqrt(iq24_t x)
{
    if (x <= 0) {
        return 0;
    }
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

    uint32_t s = 22528 + (((m >> 15) * 11) >> 5);
    s = (s + m / s) >> 1;
    s = (s + m / s) >> 1;

    int32_t rest = iq24_from_bits((uint32_t)((int64_t)m - (int64_t)s * s)); /* small */
    /*@ assert sqrt_end: -131071 <= rest <= 131071; */
    uint32_t root = (uint32_t)(((int64_t)s << 15) + rest * 16384 / (int32_t)s);
    return iq24_wrap((int64_t)((root + (UINT32_C(4) << k)) >> (k + 3)));
}

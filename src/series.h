/*
 * What the coefficients of the exact predictors share: scaled products, and how far a power series is summed.
 */
#ifndef IQFOC_SRC_SERIES_H
#define IQFOC_SRC_SERIES_H

#include "iqfoc/iq24.h"

#define ONE_Q28 (INT32_C(1) << 28)

/*
 * a b / 2^bits, rounded to nearest, 1 <= bits <= 62, for results that fit, as is said where it is called: |a
 * b| <= 2^62 and a half below 2^62 do not wrap.
 */
static inline int32_t scaled(int32_t a, int32_t b, uint32_t bits)
{
    return iq24_shift_wrap(IQ24_MUL64(a, b) + (INT64_C(1) << (bits - 1)), bits);
}

/*
 * How many terms of the mean's series, F = sum M^n/(n+1)!, count: with |M| <= b the term of M^n is below
 * n b^(n-1)/(n+1)!, and the last one kept is below a unit of Q28. b in Q28, 0 <= b < 8.
 */
static inline int32_t series_terms(int32_t bound_q28)
{
    int32_t term = ONE_Q28;
    int32_t n = 1;
    while (term > 0) {
        n++;
        term = scaled(term, bound_q28 / n, 28);
    }
    return n + 1;
}

#endif

/* Number of terms of a power series, for the coefficients of the exact predictors. */
#ifndef IQFOC_SRC_SERIES_H
#define IQFOC_SRC_SERIES_H

#include "iqfoc/iq24.h"

#define ONE_Q28 (INT32_C(1) << 28)

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
        term = iq24_mul_shift(term, bound_q28 / n, 28);
    }
    return n + 1;
}

#endif

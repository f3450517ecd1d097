/* The integer square root. */
#ifndef IQFOC_SRC_ROOT_H
#define IQFOC_SRC_ROOT_H

#include <stdint.h>

/* floor(sqrt(x)), 0 <= x < 2^62: a bit of the root at a time. For results, not for every cycle. */
static inline int32_t root_of(int64_t x)
{
    int64_t found = 0;
    /*@ loop unroll 31; */
    for (int64_t bit = INT64_C(1) << 30; bit != 0; bit /= 2) {
        if ((found + bit) * (found + bit) <= x) {
            found += bit;
        }
    }
    return (int32_t)found;
}

#endif

/* The type of IQmath that iqfoc_iqmath.h needs: a 32-bit integer on a C28x, by TI's guide. */
#ifndef TESTS_TARGET_IQMATH_TYPES_H
#define TESTS_TARGET_IQMATH_TYPES_H

#include <stdint.h>

typedef int32_t _iq24;

#endif

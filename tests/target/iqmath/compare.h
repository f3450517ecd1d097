/*
 * The functions of IQmath whose arithmetic TI documents next to those of iqfoc: over how much they differ.
 */
#ifndef TESTS_TARGET_IQMATH_COMPARE_H
#define TESTS_TARGET_IQMATH_COMPARE_H

#include <stdint.h>

typedef struct iqmath_row {
    const char *ti;
    const char *ours;
    const char *why; /* of a difference; or where they agree */
    int32_t largest; /* difference in LSB that iqmath_compare found */
} iqmath_row_t;

#define IQMATH_ROWS 9

/* Every pair of 41 extremes and `draws` pairs drawn with a fixed seed. */
void iqmath_compare(iqmath_row_t rows[IQMATH_ROWS], uint32_t draws);

#endif

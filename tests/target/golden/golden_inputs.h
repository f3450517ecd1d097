/*
 * The inputs of the golden vectors: extremes in all pairs, then seeded random numbers of every magnitude.
 */
#ifndef TESTS_TARGET_GOLDEN_INPUTS_H
#define TESTS_TARGET_GOLDEN_INPUTS_H

#include "iqfoc/iq24.h"

typedef struct golden_inputs {
    uint32_t number; /* of the input, from 0 */
    uint64_t state;
} golden_inputs_t;

#define GOLDEN_SEED UINT64_C(20190416)

/* Two numbers of any size. The first 192 * 192 draws are all pairs of the extremes. */
void golden_pair(golden_inputs_t *inputs, iq24_t *a, iq24_t *b);

/*
 * A number with |x| <= limit: now and then the limit itself, its negative or zero, else even over the range.
 */
iq24_t golden_within(golden_inputs_t *inputs, iq24_t limit);

#endif

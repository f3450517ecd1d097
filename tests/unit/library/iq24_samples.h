/*
 * Arguments for the tests of IQ24: the extreme values, and seeded random ones of every magnitude.
 *
 * IQFOC_TEST_STRIDE thins the sweeps where the full ones take too long (an emulated core); 1 is the full
 * test, and the bounds that only a full sweep can reach are asserted for 1 alone.
 */
#ifndef IQ24_SAMPLES_H
#define IQ24_SAMPLES_H

#include "iqfoc/iq24.h"

#ifndef IQFOC_TEST_STRIDE
#define IQFOC_TEST_STRIDE 1
#endif

#define IQ24_EXTREMES 192

/* All +-2^k and their neighbours, 0 and the ends of the range. Returns how many were written, at most
 * IQ24_EXTREMES. */
static inline int iq24_extremes(iq24_t values[IQ24_EXTREMES])
{
    int count = 0;
    values[count++] = 0;
    values[count++] = IQ24_MIN;
    values[count++] = IQ24_MIN + 1;
    values[count++] = IQ24_MAX;
    for (int bit = 0; bit < 31; bit++) {
        iq24_t power = (iq24_t)((uint32_t)1 << bit);
        for (iq24_t off = -1; off <= 1; off++) {
            values[count++] = power + off;
            values[count++] = -(power + off);
        }
    }
    return count;
}

/* xorshift64*: one state per test, from a fixed seed. */
typedef struct {
    uint64_t state; /* not 0 */
} iq24_random_t;

static inline uint32_t iq24_random_bits(iq24_random_t *random)
{
    random->state ^= random->state >> 12;
    random->state ^= (random->state & UINT64_C(0x7FFFFFFFFF)) << 25;
    random->state ^= random->state >> 27;
    /* The high word of state * 0x2545F4914F6CDD1D, in parts that fit 64 bits. */
    uint64_t low = (random->state & UINT32_MAX) * UINT64_C(0x4F6CDD1D);
    uint64_t cross = (random->state & UINT32_MAX) * UINT64_C(0x2545F491) & UINT32_MAX;
    uint64_t cross2 = (random->state >> 32) * UINT64_C(0x4F6CDD1D) & UINT32_MAX;
    return (uint32_t)((low >> 32) + cross + cross2);
}

/* Any bit pattern, each equally likely. */
static inline iq24_t iq24_random_any(iq24_random_t *random)
{
    return iq24_wrap((int64_t)iq24_random_bits(random));
}

/* Any magnitude, each equally likely: a random pattern shifted right by 0 ... 31. */
static inline iq24_t iq24_random_magnitude(iq24_random_t *random)
{
    iq24_t any = iq24_random_any(random);
    return any / (iq24_t)((uint32_t)1 << (iq24_random_bits(random) % 31));
}

#endif

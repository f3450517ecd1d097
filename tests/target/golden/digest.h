/*
 * A 64-bit digest of a series of numbers: equal series give equal digests on every machine.
 */
#ifndef TESTS_TARGET_DIGEST_H
#define TESTS_TARGET_DIGEST_H

#include <stdint.h>

/* FNV-1a, taking 32 bits at a time. */
#define DIGEST_START UINT64_C(0xCBF29CE484222325)

static inline void digest_add(uint64_t *digest, int32_t number)
{
    *digest = (*digest ^ (uint32_t)number) * UINT64_C(0x100000001B3);
    *digest ^= *digest >> 29; /* high bits reach low ones, which the product alone does not do */
}

#endif

/* Hashes of results, for tests to the last bit. */
#ifndef TESTS_UNIT_HASH_H
#define TESTS_UNIT_HASH_H

#include "digest.h"
#include "unity.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* All numbers of a struct that has 32-bit numbers alone. */
static inline void bits_add(uint64_t *digest, const void *numbers, size_t size)
{
    const char *from = numbers;
    for (size_t at = 0; at < size; at += sizeof(int32_t)) {
        int32_t number;
        memcpy(&number, from + at, sizeof number);
        digest_add(digest, number);
    }
}

static inline void bits_add64(uint64_t *digest, int64_t number)
{
    digest_add(digest, (int32_t)(uint32_t)(uint64_t)number);
    digest_add(digest, (int32_t)((uint64_t)number >> 32));
}

/* The hash of all results against the stored one; the message has the new one. */
static inline void bits_golden(uint64_t want, uint64_t got)
{
    char message[40];
    (void)snprintf(message, sizeof message, "the hash is %016" PRIx64, got);
    TEST_ASSERT_TRUE_MESSAGE(want == got, message);
}

#endif

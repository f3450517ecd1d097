/* One hash over all golden vectors: two programs with the same hash compute the same to the last bit. */
#ifndef TESTS_TARGET_GOLDEN_HASH_H
#define TESTS_TARGET_GOLDEN_HASH_H

#include "golden_vectors.h"

/* Over the names and digests of golden.txt's functions and configurations; a test holds it to that file. */
#define GOLDEN_HASH UINT64_C(0x08d633d4739ee7b0)

#define GOLDEN_HASH_START UINT64_C(0xCBF29CE484222325)

/* Adds one line of golden.txt. */
void golden_hash_add(uint64_t *hash, const char *name, uint64_t digest);

/* Runs golden_vectors and hands each on to `report`, unless that is NULL; the hash of all. One call at a time. */
uint64_t golden_hash(golden_report *report);

#endif

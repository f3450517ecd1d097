/*
 * Digests of every library function over many inputs, and of every configuration of the cycle, to be compared
 * between compilers and machines. Nothing but the library is needed, no C library either.
 */
#ifndef TESTS_TARGET_GOLDEN_VECTORS_H
#define TESTS_TARGET_GOLDEN_VECTORS_H

#include <stdint.h>

/* Extremes in all pairs first, then random inputs up to this many in all. */
#define GOLDEN_INPUTS 100000

/* One function's name and the digest of its results over GOLDEN_INPUTS inputs. */
typedef void golden_report(const char *name, uint64_t digest);

/* Reports all functions, in a fixed order, and then all configurations of the cycle (golden_cycle.h). */
void golden_vectors(golden_report *report);

#endif

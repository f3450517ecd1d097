/*
 * Golden vectors of overmodulation, the current reference, and the ripple of half a carrier period; part of
 * golden_vectors.h.
 */
#ifndef TESTS_TARGET_GOLDEN_LIMITS_H
#define TESTS_TARGET_GOLDEN_LIMITS_H

#include "golden_inputs.h"

/* Each adds what one input gives. */
void golden_overmodulation(golden_inputs_t *inputs, uint64_t *digest);
void golden_reference(golden_inputs_t *inputs, uint64_t *digest);
void golden_ripple_half(golden_inputs_t *inputs, uint64_t *digest);

#endif

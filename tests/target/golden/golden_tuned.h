/* Golden vector of the tuned controller and the change detector; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_TUNED_H
#define TESTS_TARGET_GOLDEN_TUNED_H

#include "golden_inputs.h"

/* One cycle: controller, watch, and its block where one is complete. */
void golden_tuned_and_watched(golden_inputs_t *inputs, uint64_t *digest);

#endif

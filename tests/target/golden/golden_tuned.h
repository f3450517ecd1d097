/* Golden vector of tuned controller, change detector and adaptation; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_TUNED_H
#define TESTS_TARGET_GOLDEN_TUNED_H

#include "golden_inputs.h"

/* One cycle: controller, watch, and the blocks of watch and adaptation where one is complete. */
void golden_tuned_and_watched(golden_inputs_t *inputs, uint64_t *digest);

#endif

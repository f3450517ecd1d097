/* Golden vectors of the self-commissioning; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_COMMISSION_H
#define TESTS_TARGET_GOLDEN_COMMISSION_H

#include "golden_inputs.h"

void golden_commission(golden_inputs_t *inputs, uint64_t *digest);

#endif

/* Golden vector of the recorder; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_RECORDER_H
#define TESTS_TARGET_GOLDEN_RECORDER_H

#include "golden_inputs.h"

/* One cycle that is recorded, and some octets of the line. */
void golden_recorder(golden_inputs_t *inputs, uint64_t *digest);

#endif

/*
 * Golden vectors of the exact predictors, the mean under modulation, control by prediction and the
 * corrections from a diagnosis; part of golden_vectors.h.
 */
#ifndef TESTS_TARGET_GOLDEN_MODELS_H
#define TESTS_TARGET_GOLDEN_MODELS_H

#include "golden_inputs.h"

/* Each adds what one input gives. */
void golden_exact(golden_inputs_t *inputs, uint64_t *digest);
void golden_salient(golden_inputs_t *inputs, uint64_t *digest);
void golden_extension(golden_inputs_t *inputs, uint64_t *digest);
void golden_modulated(golden_inputs_t *inputs, uint64_t *digest);
void golden_induction(golden_inputs_t *inputs, uint64_t *digest);
void golden_predictive_control(golden_inputs_t *inputs, uint64_t *digest);

#endif

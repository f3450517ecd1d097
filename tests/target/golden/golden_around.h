/* Golden vectors of the drive services and sensors; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_AROUND_H
#define TESTS_TARGET_GOLDEN_AROUND_H

#include "golden_inputs.h"

/* Angle sensors: encoder, resolver, Halls, the tracker behind them, and the observer. Each adds what one input gives. */
void golden_angle_sensors(golden_inputs_t *inputs, uint64_t *digest);
/* Offset calibration, shunts, start, restart and supervision. */
void golden_start_and_watch(golden_inputs_t *inputs, uint64_t *digest);

#endif

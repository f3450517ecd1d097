/* Golden vectors of the drive without an angle sensor and of the modulator by pulse pattern; part of golden_vectors.h. */
#ifndef TESTS_TARGET_GOLDEN_SENSORLESS_H
#define TESTS_TARGET_GOLDEN_SENSORLESS_H

#include "golden_inputs.h"

/* One period of a drive in closed loop: open-loop start, catch, sensor or observer, with the adaptation of L_q and the watch of the angle sensor. */
void golden_sensorless(golden_inputs_t *inputs, uint64_t *digest);
/* One cycle of the three legs, on tables that are drawn. */
void golden_pattern(golden_inputs_t *inputs, uint64_t *digest);
/* The same with the flux's trajectory, at a current near its prediction. */
void golden_pattern_control(golden_inputs_t *inputs, uint64_t *digest);
/* The edges of a drawn pattern and of drawn duties in ticks. */
void golden_edges(golden_inputs_t *inputs, uint64_t *digest);
/* A valley of a drive that goes from the carrier to patterns and back. */
void golden_pulse_mode(golden_inputs_t *inputs, uint64_t *digest);

#endif

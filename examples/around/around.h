/*
 * The drive services, a small example for each: a handler in place of those of iqfoc/hal.h. A whole drive
 * that uses most of them together is examples/template-stm32f405.
 */
#ifndef EXAMPLES_AROUND_H
#define EXAMPLES_AROUND_H

#include "iqfoc/hal.h"

/* offset.c: measures the sensors' offsets; true once they are good, and the drive may be enabled. */
bool around_offset_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);

/* start.c: turns the motor open loop, without any angle sensor. */
void around_start_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);
void around_start_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);
/* In place of one of these valleys: from it on the port's own angle, with the current and voltage as they were. */
void around_start_hand_over(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);

/* encoder.c, resolver.c, halls.c: the angle from a sensor that the port reads `at` cycles after the valley. */
void around_encoder_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, uint32_t count, iq24_t at);
void around_resolver_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, iq24_t sine, iq24_t cosine);
void around_halls_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal, uint32_t bits, uint32_t since_q8);

/* shunts.c: one trigger a period, low-side shunts. */
void around_shunts_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);

/* watch.c: status of what is connected, and restarts; once a cycle, ahead of the valley's handler. */
void around_watch(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, bool break_active);

#endif

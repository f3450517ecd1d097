/*
 * The STM32G4 example's interrupt with its port, unchanged. Memory replaces the chip's registers.
 */
#ifndef BENCH_HANDLER_H
#define BENCH_HANDLER_H

#include "inputs.h"

/* The drive enabled and settled where the input is, and the chip's registers as at a valley or at a peak. */
void bench_handler_start(const iqfoc_cycle_config_t *config);
void bench_handler_set(const bench_input_t *input, bool peak);

/* The interrupt. */
void bench_handler(void);

/* Status of its cycle. */
uint32_t bench_handler_status(void);

#endif

/*
 * The hardware abstraction layer: what a port implements, all of it.
 *
 * Four functions and one struct of the port's own. They are resolved by the linker, not by pointers, so that
 * the compiler sees every call and the worst stack can be counted. The host's port is the simulator
 * (port/host); docs/porting.md walks through a new one.
 *
 * Timing a port must provide (2019, Figs 3 to 5):
 * - the carrier's valley starts a cycle, its peak is the middle; legs are high around the peak;
 * - currents are sampled at both instants by hardware trigger, not when the interrupt gets round to it;
 * - a command written after the peak acts from the next valley (shadow registers), all three legs at once.
 */
#ifndef IQFOC_HAL_H
#define IQFOC_HAL_H

#include "cycle.h"

/* The port's own state: registers, calibration, a simulated drive. Opaque here. */
typedef struct iqfoc_hal iqfoc_hal_t;

/* Fills in the sample of the valley that caused the call. Units and ranges: iqfoc_sample_t. */
void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/* The same for the peak. */
void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/* Hands the command to the inverter's shadow registers; it acts from the next valley. gates == false acts at
 * once. */
void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command);

/* The free-running timer that stamps samples: ticks, wraps at 2^32. */
uint32_t iqfoc_hal_now(iqfoc_hal_t *hal);

/* What the interrupts call. A port's handler is one of these lines and the clearing of its flag. */
void iqfoc_isr_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);
void iqfoc_isr_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal);

#endif

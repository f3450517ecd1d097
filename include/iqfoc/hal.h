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
#include "cycle_steps.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The port's own state: registers, calibration, a simulated drive. Opaque here. */
typedef struct iqfoc_hal iqfoc_hal_t;

/* Fills in the sample of the valley that caused the call. Units and ranges: iqfoc_sample_t. */
void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/* The same for the peak. */
void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/*
 * Hands the command to the inverter's shadow registers; it acts from the next valley. gates == false
 * acts at once.
 */
void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command);

/* The free-running timer that stamps samples: ticks, wraps at 2^32. */
uint32_t iqfoc_hal_now(iqfoc_hal_t *hal);

/* From the valley to the middle of the cycle in which the peak's command acts. */
#define IQFOC_HAL_OUTPUT_MID IQ24(1.5)

/*
 * What the interrupts call: read, compute, write. A port's handler is one of these lines and the clearing
 * of its flag. Inline, so that the library itself asks nothing of a port, and a shared one links without.
 *
 * For the methods that the drive names, a constant (iqfoc/cycle_steps.h):
 */
IQFOC_STEP void iqfoc_isr_valley_by(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    iqfoc_cycle_valley_by(methods, cycle, &sample, now);
}

IQFOC_STEP void iqfoc_isr_peak_by(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak_by(methods, cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    if (!iqfoc_cycle_in_time(cycle, &sample, iqfoc_hal_now(hal)) && cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    iqfoc_hal_write(hal, &command);
}

/* The same with the ready-made cycle. */
static inline void iqfoc_isr_valley(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    iqfoc_cycle_valley(cycle, &sample, now);
}

static inline void iqfoc_isr_peak(iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_peak(hal, &sample);
    iqfoc_command_t command = iqfoc_cycle_peak(cycle, &sample, IQFOC_HAL_OUTPUT_MID, now);
    if (!iqfoc_cycle_in_time(cycle, &sample, iqfoc_hal_now(hal)) && cycle->tripped) {
        command = iqfoc_cycle_safe(cycle->config);
    }
    iqfoc_hal_write(hal, &command);
}

#ifdef __cplusplus
}
#endif

#endif

/*
 * The hardware abstraction layer: the four functions and the one struct that a port implements, and a fifth function for pulse patterns.
 *
 * The linker resolves them, not pointers, so that the compiler sees every call and the worst stack can be counted. A drive that does not
 * call the fifth links without it. The host's port is the simulator (port/host); docs/porting.md leads through a new one.
 *
 * Timing that a port must provide (2019, Figs 3 to 5):
 * - The carrier's valley starts a cycle, its peak is the middle; legs are high around the peak.
 * - Currents are sampled at both instants by hardware trigger, not when the interrupt starts.
 * - A command written after the peak acts from the next valley (shadow registers), on all three legs at once.
 */
#ifndef IQFOC_HAL_H
#define IQFOC_HAL_H

#include "cycle.h"
#include "cycle_steps.h"
#include "edges.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The port's own state: registers, calibration, a simulated drive. Opaque here. */
typedef struct iqfoc_hal iqfoc_hal_t;

/*
 * Fills in the sample of the valley that caused the call. From the valley's interrupt. Units and ranges:
 * iqfoc_sample_t.
 */
void iqfoc_hal_read_valley(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/* The same for the peak, from the peak's interrupt. */
void iqfoc_hal_read_peak(iqfoc_hal_t *hal, iqfoc_sample_t *sample);

/*
 * Writes the command to the inverter's shadow registers; it acts from the next valley. gates == false acts at once.
 * From the valley's and the peak's interrupt.
 */
void iqfoc_hal_write(iqfoc_hal_t *hal, const iqfoc_command_t *command);

/* The free-running timer that stamps samples: ticks, wraps at 2^32. */
uint32_t iqfoc_hal_now(iqfoc_hal_t *hal);

/*
 * Optional: the edges of the next cycle and its length, in ticks of the carrier's timer, in place of iqfoc_hal_write. Once in each cycle,
 * from the valley's or the peak's interrupt. The gates are then on, as after a command with gates == true.
 *
 * The edges act from the next valley on, for one cycle, on all three legs. If a leg's level at the valley is another one than
 * edges->leg[].level, it changes at the valley. If nothing is written in a cycle, the legs keep their levels through the next one. A port
 * may need the edges some time ahead of the valley; it drops a later write. iqfoc_hal_write with gates == false acts at once, as ever, and
 * drops the edges that wait.
 *
 * Exact to a tick, if two edges of a leg have the port's least distance (docs/porting.md); IQFOC_EDGES_LEAST gives it to the pattern.
 */
void iqfoc_hal_write_edges(iqfoc_hal_t *hal, const iqfoc_edges_t *edges);

/* From the valley to the middle of the cycle in which the peak's command acts. */
#define IQFOC_HAL_OUTPUT_MID IQ24(1.5)

/*
 * The interrupts' handlers: read, compute, write. A port's handler is one of these lines and the clearing of its
 * flag. They are inline, so that the library itself needs no port, and a shared library links without one. If the
 * valley or the peak trips, they write the safe command at once.
 *
 * For the methods that the drive names, a constant (iqfoc/cycle_steps.h):
 */
/* For a valley that trips: writes the safe command at once, not half a cycle later. */
static inline void iqfoc_isr_stop(const iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    const iqfoc_command_t safe = iqfoc_cycle_safe(cycle->config);
    iqfoc_hal_write(hal, &safe);
}

IQFOC_STEP void iqfoc_isr_valley_by(const iqfoc_methods_t methods, iqfoc_cycle_t *cycle, iqfoc_hal_t *hal)
{
    iqfoc_sample_t sample;
    const uint32_t now = iqfoc_hal_now(hal);
    iqfoc_hal_read_valley(hal, &sample);
    if (iqfoc_cycle_valley_by(methods, cycle, &sample, now)) {
        iqfoc_isr_stop(cycle, hal);
    }
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
    if (iqfoc_cycle_valley(cycle, &sample, now)) {
        iqfoc_isr_stop(cycle, hal);
    }
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

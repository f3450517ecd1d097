/*
 * The control cycle with methods chosen at compile time, as a drive's interrupts run it: a pair of functions for each configuration of
 * docs/bench.md. They call the library's own steps and nothing else.
 */
#ifndef BENCH_DRIVES_H
#define BENCH_DRIVES_H

#include "iqfoc/cycle.h"

#include "inputs.h"

/* The names of all configurations; what each is made of: drives.c. */
#define BENCH_DRIVES(X)                                                                                      \
    X(isr_cycle)                                                                                             \
    X(isr_midpoint)                                                                                          \
    X(isr_corrected_mean)                                                                                    \
    X(isr_exact)                                                                                             \
    X(isr_salient)                                                                                           \
    X(isr_flux)                                                                                              \
    X(isr_flux_map)                                                                                          \
    X(isr_mean_modulated)                                                                                    \
    X(isr_six_step)                                                                                          \
    X(isr_extended)                                                                                          \
    X(isr_deadbeat)                                                                                          \
    X(isr_deadbeat_exact)                                                                                    \
    X(isr_deadbeat_learning)

#define BENCH_DRIVE_DECLARED(name)                                                                           \
    bool bench_##name##_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);            \
    iqfoc_command_t bench_##name##_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample,                  \
                                        iq24_t output_mid, uint32_t now);
BENCH_DRIVES(BENCH_DRIVE_DECLARED)

/* The benchmark's configuration with all that any of the methods needs, at a speed in the middle of the inputs'. */
const iqfoc_cycle_config_t *bench_drives_config(void);

#endif

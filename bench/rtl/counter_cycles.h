/*
 * Counts clock cycles on a simulated core: a word of bench.sv, so that no core needs a counter of its own.
 */
#ifndef BENCH_RTL_COUNTER_CYCLES_H
#define BENCH_RTL_COUNTER_CYCLES_H

#include <stdint.h>

#define COUNTER_UNIT "cycles"

static inline void counter_start(void)
{
}

static inline uint32_t counter_read(void)
{
    __asm volatile("" ::: "memory");
    const uint32_t cycles = *(const volatile uint32_t *)0xF0000008U;
    __asm volatile("" ::: "memory");
    return cycles;
}

static inline uint32_t counter_units(uint32_t difference)
{
    return difference;
}

#endif

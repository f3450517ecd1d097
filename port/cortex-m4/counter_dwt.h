/*
 * Counts clock cycles on a real Cortex-M4: the core's own counter, DWT CYCCNT (Armv7-M ARM, C1.8).
 *
 * Chosen by -DIQFOC_BENCH_DWT=ON; QEMU does not have the register.
 */
#ifndef PORT_COUNTER_H
#define PORT_COUNTER_H

#include <stdint.h>

#define COUNTER_UNIT "cycles"

#define ARM_DEMCR      (*(volatile uint32_t *)0xE000EDFC)
#define ARM_DWT_CTRL   (*(volatile uint32_t *)0xE0001000)
#define ARM_DWT_CYCCNT (*(volatile uint32_t *)0xE0001004)

static inline void counter_start(void)
{
    ARM_DEMCR |= UINT32_C(1) << 24; /* TRCENA: the trace blocks are on */
    ARM_DWT_CYCCNT = 0;
    ARM_DWT_CTRL |= 1; /* CYCCNTENA */
}

static inline uint32_t counter_read(void)
{
    return ARM_DWT_CYCCNT;
}

static inline uint32_t counter_units(uint32_t difference)
{
    return difference;
}

#endif

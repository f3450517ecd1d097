/*
 * Counts executed instructions on the emulated Cortex-M4, exactly.
 *
 * With -icount shift=10 QEMU lets 1024 ns pass per instruction, and the 25 MHz timer counts 25.6 ticks in
 * that time. The ticks of n instructions lie within one of 25.6 n, so that rounding to the nearest gives n.
 */
#ifndef PORT_COUNTER_H
#define PORT_COUNTER_H

#include "mps2_an386.h"

#define COUNTER_UNIT "instructions"

static inline void counter_start(void)
{
    MPS2_TIMER0->reload = UINT32_MAX;
    MPS2_TIMER0->value = UINT32_MAX;
    MPS2_TIMER0->ctrl = MPS2_TIMER_CTRL_ENABLE;
}

/* Grows by one per tick. */
static inline uint32_t counter_read(void)
{
    return ~MPS2_TIMER0->value;
}

/* Instructions in a difference of two readings. */
static inline uint32_t counter_units(uint32_t difference)
{
    return (difference * 5 + 64) / 128;
}

#endif

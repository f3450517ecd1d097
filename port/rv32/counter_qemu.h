/*
 * Counts executed instructions on RV32, exactly: the CSR minstret. Under QEMU it counts with -icount shift=0.
 */
#ifndef PORT_COUNTER_H
#define PORT_COUNTER_H

#include <stdint.h>

#define COUNTER_UNIT "instructions"

static inline void counter_start(void)
{
}

static inline uint32_t counter_read(void)
{
    uint32_t count;
    __asm volatile("csrr %0, minstret" : "=r"(count)::"memory");
    return count;
}

static inline uint32_t counter_units(uint32_t difference)
{
    return difference;
}

#endif

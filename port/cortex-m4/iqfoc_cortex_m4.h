/*
 * Target header for Cortex-M4 with gcc or clang: compile the library with
 * -DIQFOC_TARGET_HEADER='"iqfoc_cortex_m4.h"'.
 *
 * Same results, fewer instructions: the core's two multiplies by name. A compiler left to itself keeps some
 * 32-bit factors in 64 bits and multiplies by them with four instructions (gcc 12.2: the whole cycle by a
 * tenth more).
 */
#ifndef PORT_CORTEX_M4_IQFOC_CORTEX_M4_H
#define PORT_CORTEX_M4_IQFOC_CORTEX_M4_H

#include <stdint.h>

static inline int64_t iqfoc_cortex_m4_mul64(int32_t a, int32_t b)
{
    int64_t product;
    __asm("smull %Q0, %R0, %1, %2" : "=r"(product) : "r"(a), "r"(b));
    return product;
}

static inline int64_t iqfoc_cortex_m4_mac64(int64_t sum, int32_t a, int32_t b)
{
    __asm("smlal %Q0, %R0, %1, %2" : "+r"(sum) : "r"(a), "r"(b));
    return sum;
}

#define IQ24_MUL64(a, b)      iqfoc_cortex_m4_mul64(a, b)
#define IQ24_MAC64(sum, a, b) iqfoc_cortex_m4_mac64(sum, a, b)

#endif

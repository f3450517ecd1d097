/*
 * In place of CMSIS-Core's header of this name, for who has CMSIS-DSP alone: what the functions that are counted use of it.
 */
#ifndef PEER_CMSIS_COMPILER_H
#define PEER_CMSIS_COMPILER_H

#include <arm_acle.h>
#include <stdint.h>

#define __STATIC_FORCEINLINE static inline __attribute__((always_inline))
#define __STATIC_INLINE      static inline
#define __ALIGNED(x)         __attribute__((aligned(x)))
#define __WEAK               __attribute__((weak))
#define __SSAT(x, bits)      __ssat(x, bits)
#define __USAT(x, bits)      __usat(x, bits)
#define __QADD(a, b)         __qadd(a, b)
#define __QSUB(a, b)         __qsub(a, b)
#define __CLZ(x)             ((uint8_t)__clz(x))
#define __SMUAD(a, b)        ((uint32_t)__smuad((int16x2_t)(a), (int16x2_t)(b)))
#define __SMLALD(a, b, sum)  ((uint64_t)__smlald((int16x2_t)(a), (int16x2_t)(b), (int64_t)(sum)))
#define __ASM                __asm

#endif

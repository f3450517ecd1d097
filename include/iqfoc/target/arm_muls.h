/*
 * IQ24's hooks for Arm cores whose only multiply gives 32 bits: Cortex-M0, M0+, M1, M23. gcc, clang and
 * Arm's compiler; chosen by target/choose.h.
 *
 * Left to itself the compiler calls __aeabi_lmul, which multiplies 64 by 64 bits and costs twice as much.
 * The function here makes the product of the four of 16-bit halves, with the same bits. Inline it would
 * take twice the code and more instructions, as there are eight registers for all of it.
 */
#ifndef IQFOC_TARGET_ARM_MULS_H
#define IQFOC_TARGET_ARM_MULS_H

#include "detect.h"

#if !IQFOC_TARGET_HAS_ARM_MULS
#error                                                                                                       \
    "iqfoc/target/arm_muls.h is for Arm cores without a long multiply (Cortex-M0, M0+, M1, M23); this compiler targets another core: leave IQFOC_TARGET_HEADER undefined"
#endif

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* a b, exact; src/arm_muls.c. 20 instructions. */
int64_t iqfoc_arm_mul64(int32_t a, int32_t b) __attribute__((const));

#ifdef __cplusplus
}
#endif

#define IQ24_MUL64(a, b) iqfoc_arm_mul64(a, b)

#endif

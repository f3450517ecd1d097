/*
 * IQ24's hooks for Arm cores whose only multiply gives 32 bits: Cortex-M0, M0+, M1, M23. gcc, clang and
 * Arm's compiler; chosen by target/choose.h.
 *
 * Left to itself the compiler calls __aeabi_lmul, which multiplies 64 by 64 bits and costs twice as much.
 * The functions here make the product of the four of 16-bit halves, with the same bits. Inline it would
 * take twice the code and more instructions, as there are eight registers for all of it. Sine and cosine,
 * nine products whose factors are small or shared, are one function, and so are the rotor's two polynomials.
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

/* src/arm_muls.c. a b, exact: 18 instructions. */
int64_t iqfoc_arm_mul64(int32_t a, int32_t b) __attribute__((const));
/* sum + a b modulo 2^64: 20. */
int64_t iqfoc_arm_mac64(int64_t sum, int32_t a, int32_t b) __attribute__((const));
/* a b + c d modulo 2^64: 36. */
int64_t iqfoc_arm_sum64(int32_t a, int32_t b, int32_t c, int32_t d) __attribute__((const));
/* floor(a b / 2^32), and to nearest, ties up: 17. */
int32_t iqfoc_arm_high(int32_t a, int32_t b) __attribute__((const));
int32_t iqfoc_arm_high_round(int32_t a, int32_t b) __attribute__((const));
/* src/arm_sincos.c. Cosine 2^32 + sine in Q30, as iq24_sincos_q30_inline has them: 144. */
int64_t iqfoc_arm_sincos_q30(int32_t turns) __attribute__((const));
/* src/arm_rotor.c. P2 2^32 + P1 of iqfoc_rotor_shape, with its polynomials: 139. */
int64_t iqfoc_arm_rotor(int32_t speed, const int32_t *poly) __attribute__((pure));

#ifdef __cplusplus
}
#endif

#define IQ24_MUL64(a, b)                     iqfoc_arm_mul64(a, b)
#define IQ24_MAC64(sum, a, b)                iqfoc_arm_mac64(sum, a, b)
#define IQ24_SUM64(a, b, c, d)               iqfoc_arm_sum64(a, b, c, d)
#define IQ24_HIGH(a, b)                      iqfoc_arm_high(a, b)
#define IQ24_HIGH_ROUND(a, b)                iqfoc_arm_high_round(a, b)
#define IQ24_SINCOS_Q30(turns)               iqfoc_arm_sincos_q30(turns)
#define IQFOC_ROTOR_POLYNOMIALS(speed, poly) iqfoc_arm_rotor(speed, poly)

#endif

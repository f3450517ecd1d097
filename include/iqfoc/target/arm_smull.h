/*
 * IQ24's hooks for Arm cores that multiply 32 by 32 bits to 64: Cortex-M3, M4, M7, M33 and up, Cortex-R,
 * and Cortex-A in its 32-bit state. gcc, clang and Arm's compiler; chosen by target/choose.h.
 *
 * Same results, fewer instructions: the core's multiply, multiply-accumulate and saturation by name. A
 * compiler left to itself keeps some 32-bit factors in 64 bits and multiplies by them with four
 * instructions, and compares where the core can saturate (docs/bench.md).
 *
 * The instructions take the two halves of a sum as registers of their own. As one 64-bit operand they
 * would have to be neighbours, which costs a move for every second product (gcc 12.2).
 *
 * They are volatile although they only compute: that keeps them in the order in which they are written.
 * Free to reorder them, the compiler loads all operands ahead and then has no register left to hold them:
 * current control took 116 instructions instead of 103.
 */
#ifndef IQFOC_TARGET_ARM_SMULL_H
#define IQFOC_TARGET_ARM_SMULL_H

#include "detect.h"

#if !IQFOC_TARGET_HAS_ARM_SMULL
#error                                                                                                       \
    "iqfoc/target/arm_smull.h is for Arm cores with SMULL, SMLAL and SSAT (Cortex-M3 and up); this compiler targets another core: leave IQFOC_TARGET_HEADER undefined, or give the compiler the right -mcpu"
#endif

#include <stdint.h>

static inline int64_t iqfoc_arm_join(uint32_t low, uint32_t high)
{
    return (int64_t)((uint64_t)high << 32 | low);
}

static inline int64_t iqfoc_arm_mul64(int32_t a, int32_t b)
{
    uint32_t low;
    uint32_t high;
    __asm volatile("smull %0, %1, %2, %3" : "=r"(low), "=r"(high) : "r"(a), "r"(b));
    return iqfoc_arm_join(low, high);
}

static inline int64_t iqfoc_arm_mac64(int64_t sum, int32_t a, int32_t b)
{
    uint32_t low = (uint32_t)sum;
    uint32_t high = (uint32_t)((uint64_t)sum >> 32);
    __asm volatile("smlal %0, %1, %2, %3" : "+r"(low), "+r"(high) : "r"(a), "r"(b));
    return iqfoc_arm_join(low, high);
}

#define IQ24_MUL64(a, b)      iqfoc_arm_mul64(a, b)
#define IQ24_MAC64(sum, a, b) iqfoc_arm_mac64(sum, a, b)

/*
 * The high word of a product: alone, added to a sum, rounded. Armv7E-M (M4, M7, M33 with its DSP instructions) has
 * one instruction for each; Cortex-M3 uses the long product and its high half. They are not volatile: the compiler
 * may drop an unused result.
 *
 */
static inline int32_t iqfoc_arm_high(int32_t a, int32_t b)
{
    int32_t high;
#ifdef __ARM_FEATURE_DSP
    __asm("smmul %0, %1, %2" : "=r"(high) : "r"(a), "r"(b));
#else
    uint32_t low;
    __asm("smull %0, %1, %2, %3" : "=r"(low), "=r"(high) : "r"(a), "r"(b));
#endif
    return high;
}

static inline int32_t iqfoc_arm_high_round(int32_t a, int32_t b)
{
    int32_t high;
#ifdef __ARM_FEATURE_DSP
    __asm("smmulr %0, %1, %2" : "=r"(high) : "r"(a), "r"(b));
#else
    uint32_t low;
    __asm("smull %0, %1, %2, %3\n\tadd %1, %1, %0, lsr #31" : "=&r"(low), "=&r"(high) : "r"(a), "r"(b));
#endif
    return high;
}

#ifdef __ARM_FEATURE_DSP
static inline int32_t iqfoc_arm_high_add(int32_t c, int32_t a, int32_t b)
{
    int32_t sum;
    __asm("smmla %0, %1, %2, %3" : "=r"(sum) : "r"(a), "r"(b), "r"(c));
    return sum;
}

static inline int32_t iqfoc_arm_high_sub(int32_t c, int32_t a, int32_t b)
{
    int32_t sum;
    __asm("smmls %0, %1, %2, %3" : "=r"(sum) : "r"(a), "r"(b), "r"(c));
    return sum;
}

static inline int32_t iqfoc_arm_high_round_add(int32_t c, int32_t a, int32_t b)
{
    int32_t sum;
    __asm("smmlar %0, %1, %2, %3" : "=r"(sum) : "r"(a), "r"(b), "r"(c));
    return sum;
}

#define IQ24_HIGH_ADD(c, a, b)       iqfoc_arm_high_add(c, a, b)
#define IQ24_HIGH_PLUS(c, a, b)      iqfoc_arm_high_add(c, a, b)
#define IQ24_HIGH_SUB(c, a, b)       iqfoc_arm_high_sub(c, a, b)
#define IQ24_HIGH_ROUND_ADD(c, a, b) iqfoc_arm_high_round_add(c, a, b)
#endif
#define IQ24_HIGH(a, b)       iqfoc_arm_high(a, b)
#define IQ24_HIGH_ROUND(a, b) iqfoc_arm_high_round(a, b)

/*
 * Two neighbouring words by one instruction: gcc joins two loads only where no other instruction comes between. "Uv" is
 * an address with an offset that LDRD has. Not on Cortex-M3, where an interrupt can spoil the base (erratum 602117).
 */
#if defined(__ARM_FEATURE_DSP) && defined(__thumb__) && !defined(__clang__)
#define IQ24_LOAD_PAIR(x, y, first, second)                                                                  \
    __asm("ldrd %0, %1, %2" : "=r"(x), "=r"(y) : "Uv"(first), "m"(second))
#endif

/* By the difference where it is negative, else by 0: four instructions, where moves under a condition take six. */
#define IQ24_ORDER(low, high)                                                                                \
    do {                                                                                                     \
        const iq24_t apart_ = iq24_sub_wrap(high, low);                                                      \
        const iq24_t below_ = apart_ & iq24_asr32(apart_, 31);                                               \
        (low) = iq24_add_wrap(low, below_);                                                                  \
        (high) = iq24_sub_wrap(high, below_);                                                                \
    } while (0)

/* A macro throughout: the instruction wants the number of bits as a constant. */
#define IQ24_HOLD_BITS(x, bits)                                                                              \
    __extension__({                                                                                          \
        int32_t held_;                                                                                       \
        __asm volatile("ssat %0, %1, %2" : "=r"(held_) : "I"(bits), "r"(x));                                 \
        held_;                                                                                               \
    })

#endif

/*
 * Exact products on cores that multiply to 32 bits (include/iqfoc/target/arm_muls.h); elsewhere this file
 * holds nothing.
 */
#include "iqfoc/target/detect.h"

#include <stdint.h>

#if IQFOC_TARGET_HAS_ARM_MULS
#include "iqfoc/target/arm_muls.h"

/*
 * With a = ah 2^16 + al and b = bh 2^16 + bl, |ah|, |bh| <= 2^15 and 0 <= al, bl < 2^16:
 *
 *     t    = al bh + (al bl >> 16),     m = t + ah bl
 *     high = ah bh + (m >> 16),         low = a b mod 2^32
 *
 * Range: |al bh| <= 65535 2^15 = 2^31 - 2^15, and what is added to it is below 2^16 and not negative: t >=
 * -2^31 + 2^15, and t <= 65535 (2^15 - 1) + 65534 < 2^31, as bh <= 2^15 - 1 where it is positive. m may leave
 * 32 bits, within 2^32: the core's V flag says so, and m >> 16 is then that of the 32 bits with its upper half
 * turned over. high is that of the true product, within 2^30. tests/target runs iq24's tests through all of them.
 */

/* A factor's halves: the lower without a sign, the upper with it. `high` may be the factor itself. */
#define HALVES(low, high, factor)                                                                            \
    "uxth " low ", " factor "\n\t"                                                                           \
    "asrs " high ", " factor ", #16\n\t"

/* From the halves: m in al, its V in the flags, and ah bh in bh. bl and `spare` are used up. */
#define FOUR_PRODUCTS(al, ah, bl, bh, spare)                                                                 \
    "movs " spare ", " al "\n\t"                                                                             \
    "muls " spare ", " bl "\n\t" /* al bl */                                                                 \
    "muls " al ", " bh "\n\t"    /* al bh */                                                                 \
    "lsrs " spare ", " spare ", #16\n\t"                                                                     \
    "adds " al ", " al ", " spare "\n\t" /* t */                                                             \
    "muls " bl ", " ah "\n\t"            /* ah bl */                                                         \
    "muls " bh ", " ah "\n\t"            /* ah bh */                                                         \
    "adds " al ", " al ", " bl "\n\t"    /* m */

/* m >> 16 where m fits, and, its upper half turned over, where it does not. The last bit out stays in C. */
#define MIDDLE(m) "asrs " m ", " m ", #16\n\t"
#define MIDDLE_OVER(m, spare)                                                                                \
    "movs " spare ", #1\n\t"                                                                                 \
    "lsls " spare ", " spare ", #16\n\t"                                                                     \
    "rsbs " spare ", " spare ", #0\n\t" MIDDLE(m) "eors " m ", " spare "\n\t"

__attribute__((naked)) int64_t iqfoc_arm_mul64(__attribute__((unused)) int32_t a,
                                               __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, lr}\n\t" /* clang-format off */
                   HALVES("r2", "r3", "r0")
                   "muls r0, r1\n\t" /* low */
                   HALVES("r4", "r1", "r1")
                   FOUR_PRODUCTS("r2", "r3", "r4", "r1", "r5")
                   "bvs 1f\n\t"
                   MIDDLE("r2")
                   "adds r1, r1, r2\n\t"
                   "pop {r4, r5, pc}\n"
                   "1:\t" MIDDLE_OVER("r2", "r3") /* clang-format on */
                   "adds r1, r1, r2\n\t"
                   "pop {r4, r5, pc}");
}

/* The same, added to a sum modulo 2^64. */
__attribute__((naked)) int64_t iqfoc_arm_mac64(__attribute__((unused)) int64_t sum,
                                               __attribute__((unused)) int32_t a,
                                               __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, r6, r7, lr}\n\t" /* clang-format off */
                   HALVES("r4", "r5", "r2")
                   "muls r2, r3\n\t" /* low */
                   HALVES("r6", "r3", "r3")
                   FOUR_PRODUCTS("r4", "r5", "r6", "r3", "r7")
                   "bvs 1f\n\t"
                   MIDDLE("r4") /* clang-format on */
                   "2:\tadds r3, r3, r4\n\t"
                   "adds r0, r0, r2\n\t"
                   "adcs r1, r3\n\t"
                   "pop {r4, r5, r6, r7, pc}\n"
                   "1:\t" /* clang-format off */ MIDDLE_OVER("r4", "r5") /* clang-format on */
                   "b 2b");
}

/* The sum of two products modulo 2^64. */
__attribute__((naked)) int64_t iqfoc_arm_sum64(__attribute__((unused)) int32_t a,
                                               __attribute__((unused)) int32_t b,
                                               __attribute__((unused)) int32_t c,
                                               __attribute__((unused)) int32_t d)
{
    __asm volatile(
        ".syntax unified\n\t"
        "push {r4, r5, r6, r7, lr}\n\t" /* clang-format off */
                   HALVES("r4", "r5", "r0")
                   "muls r0, r1\n\t" /* low */
                   HALVES("r6", "r1", "r1")
                   FOUR_PRODUCTS("r4", "r5", "r6", "r1", "r7")
                   "bvs 1f\n\t"
                   MIDDLE("r4") /* clang-format on */
        "2:\tadds r1, r1, r4\n\t" /* clang-format off */
                   HALVES("r4", "r5", "r2")
                   "muls r2, r3\n\t" /* low */
                   HALVES("r6", "r3", "r3")
                   FOUR_PRODUCTS("r4", "r5", "r6", "r3", "r7")
                   "bvs 3f\n\t"
                   MIDDLE("r4") /* clang-format on */
        "4:\tadds r3, r3, r4\n\t"
        "adds r0, r0, r2\n\t"
        "adcs r1, r3\n\t"
        "pop {r4, r5, r6, r7, pc}\n"
        "1:\t" /* clang-format off */ MIDDLE_OVER("r4", "r5") /* clang-format on */
        "b 2b\n"
        "3:\t" /* clang-format off */ MIDDLE_OVER("r4", "r5") /* clang-format on */
        "b 4b");
}

/*
 * The high word alone, and to nearest: the last bit that m >> 16 drops is half of its unit, and `add` is then the
 * sum that takes C with it.
 */
#define HIGH_WORD(add)                                                                                       \
    ".syntax unified\n\t"                                                                                    \
    "push {r4, lr}\n\t" HALVES("r2", "r1", "r1") HALVES("r3", "r0", "r0")                                    \
        FOUR_PRODUCTS("r2", "r1", "r3", "r0", "r4") "bvs 1f\n\t" MIDDLE("r2") add                            \
        " r0, r2\n\t"                                                                                        \
        "pop {r4, pc}\n"                                                                                     \
        "1:\t" MIDDLE_OVER("r2", "r3") add " r0, r2\n\t"                                                     \
                                           "pop {r4, pc}"

__attribute__((naked)) int32_t iqfoc_arm_high(__attribute__((unused)) int32_t a,
                                              __attribute__((unused)) int32_t b)
{
    __asm volatile(HIGH_WORD("adds"));
}

__attribute__((naked)) int32_t iqfoc_arm_high_round(__attribute__((unused)) int32_t a,
                                                    __attribute__((unused)) int32_t b)
{
    __asm volatile(HIGH_WORD("adcs"));
}
#else
/* A source file may not be empty. */
typedef int32_t iqfoc_arm_muls_not_needed;
#endif

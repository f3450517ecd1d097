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
 * turned over. high is that of the true product, within 2^30. tests/target runs iq24's tests through all four.
 */
__attribute__((naked)) int64_t iqfoc_arm_mul64(__attribute__((unused)) int32_t a,
                                               __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, lr}\n\t"
                   "uxth r2, r0\n\t"      /* al */
                   "asrs r3, r0, #16\n\t" /* ah */
                   "muls r0, r1\n\t"      /* low */
                   "uxth r4, r1\n\t"      /* bl */
                   "asrs r1, r1, #16\n\t" /* bh */
                   "movs r5, r2\n\t"
                   "muls r5, r4\n\t" /* al bl */
                   "muls r2, r1\n\t" /* al bh */
                   "lsrs r5, r5, #16\n\t"
                   "adds r2, r2, r5\n\t" /* t */
                   "muls r4, r3\n\t"     /* ah bl */
                   "muls r1, r3\n\t"     /* ah bh */
                   "adds r2, r2, r4\n\t" /* m */
                   "bvs 1f\n\t"
                   "asrs r2, r2, #16\n\t"
                   "adds r1, r1, r2\n\t"
                   "pop {r4, r5, pc}\n"
                   "1:\tmovs r3, #1\n\t"
                   "lsls r3, r3, #16\n\t"
                   "rsbs r3, r3, #0\n\t" /* the upper half */
                   "asrs r2, r2, #16\n\t"
                   "eors r2, r3\n\t"
                   "adds r1, r1, r2\n\t"
                   "pop {r4, r5, pc}");
}

/* The same, added to a sum modulo 2^64. */
__attribute__((naked)) int64_t iqfoc_arm_mac64(__attribute__((unused)) int64_t sum,
                                               __attribute__((unused)) int32_t a,
                                               __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, r6, r7, lr}\n\t"
                   "uxth r4, r2\n\t"      /* al */
                   "asrs r5, r2, #16\n\t" /* ah */
                   "muls r2, r3\n\t"      /* low */
                   "uxth r6, r3\n\t"      /* bl */
                   "asrs r3, r3, #16\n\t" /* bh */
                   "movs r7, r4\n\t"
                   "muls r7, r6\n\t" /* al bl */
                   "muls r4, r3\n\t" /* al bh */
                   "lsrs r7, r7, #16\n\t"
                   "adds r4, r4, r7\n\t" /* t */
                   "muls r6, r5\n\t"     /* ah bl */
                   "muls r3, r5\n\t"     /* ah bh */
                   "adds r4, r4, r6\n\t" /* m */
                   "bvs 1f\n\t"
                   "asrs r4, r4, #16\n"
                   "2:\tadds r3, r3, r4\n\t"
                   "adds r0, r0, r2\n\t"
                   "adcs r1, r3\n\t"
                   "pop {r4, r5, r6, r7, pc}\n"
                   "1:\tmovs r5, #1\n\t"
                   "lsls r5, r5, #16\n\t"
                   "rsbs r5, r5, #0\n\t"
                   "asrs r4, r4, #16\n\t"
                   "eors r4, r5\n\t"
                   "b 2b");
}

/* The high word alone. */
__attribute__((naked)) int32_t iqfoc_arm_high(__attribute__((unused)) int32_t a,
                                              __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, lr}\n\t"
                   "uxth r2, r0\n\t"      /* al */
                   "asrs r0, r0, #16\n\t" /* ah */
                   "uxth r3, r1\n\t"      /* bl */
                   "asrs r1, r1, #16\n\t" /* bh */
                   "movs r4, r2\n\t"
                   "muls r4, r3\n\t" /* al bl */
                   "muls r2, r1\n\t" /* al bh */
                   "lsrs r4, r4, #16\n\t"
                   "adds r2, r2, r4\n\t" /* t */
                   "muls r3, r0\n\t"     /* ah bl */
                   "muls r0, r1\n\t"     /* ah bh */
                   "adds r2, r2, r3\n\t" /* m */
                   "bvs 1f\n\t"
                   "asrs r2, r2, #16\n\t"
                   "adds r0, r0, r2\n\t"
                   "pop {r4, pc}\n"
                   "1:\tmovs r3, #1\n\t"
                   "lsls r3, r3, #16\n\t"
                   "rsbs r3, r3, #0\n\t"
                   "asrs r2, r2, #16\n\t"
                   "eors r2, r3\n\t"
                   "adds r0, r0, r2\n\t"
                   "pop {r4, pc}");
}

/* The high word to nearest: the last bit that m >> 16 drops is half of its unit, and the shift leaves it in C. */
__attribute__((naked)) int32_t iqfoc_arm_high_round(__attribute__((unused)) int32_t a,
                                                    __attribute__((unused)) int32_t b)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, lr}\n\t"
                   "uxth r2, r0\n\t"      /* al */
                   "asrs r0, r0, #16\n\t" /* ah */
                   "uxth r3, r1\n\t"      /* bl */
                   "asrs r1, r1, #16\n\t" /* bh */
                   "movs r4, r2\n\t"
                   "muls r4, r3\n\t" /* al bl */
                   "muls r2, r1\n\t" /* al bh */
                   "lsrs r4, r4, #16\n\t"
                   "adds r2, r2, r4\n\t" /* t */
                   "muls r3, r0\n\t"     /* ah bl */
                   "muls r0, r1\n\t"     /* ah bh */
                   "adds r2, r2, r3\n\t" /* m */
                   "bvs 1f\n\t"
                   "asrs r2, r2, #16\n\t"
                   "adcs r0, r2\n\t"
                   "pop {r4, pc}\n"
                   "1:\tmovs r3, #1\n\t"
                   "lsls r3, r3, #16\n\t"
                   "rsbs r3, r3, #0\n\t"
                   "asrs r2, r2, #16\n\t"
                   "eors r2, r3\n\t"
                   "adcs r0, r2\n\t"
                   "pop {r4, pc}");
}
#else
/* A source file may not be empty. */
typedef int32_t iqfoc_arm_muls_not_needed;
#endif

/*
 * The exact 64-bit product on cores that multiply to 32 bits (include/iqfoc/target/arm_muls.h); elsewhere
 * this file holds nothing.
 */
#include "iqfoc/target/detect.h"

#include <stdint.h>

#if IQFOC_TARGET_HAS_ARM_MULS
#include "iqfoc/target/arm_muls.h"

/*
 * With a = ah 2^16 + al and b = bh 2^16 + bl, |ah|, |bh| <= 2^15 and 0 <= al, bl < 2^16:
 *
 *     t    = al bh + (al bl >> 16)
 *     t'   = ah bl + (t mod 2^16)
 *     high = ah bh + (t >> 16) + (t' >> 16),     low = a b mod 2^32
 *
 * Range: |al bh| <= 65535 2^15 = 2^31 - 2^15, and what is added to it and to ah bl is below 2^16 and not
 * negative: t >= -2^31 + 2^15, and t <= 65535 (2^15 - 1) + 65534 < 2^31, as bh <= 2^15 - 1 where it is
 * positive. The same bounds t'. high is that of the true product, within 2^30. tests/target runs iq24's
 * tests through it.
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
                   "muls r4, r3\n\t" /* ah bl */
                   "muls r1, r3\n\t" /* ah bh */
                   "lsrs r5, r5, #16\n\t"
                   "adds r2, r2, r5\n\t" /* t */
                   "uxth r5, r2\n\t"
                   "adds r4, r4, r5\n\t" /* t' */
                   "asrs r2, r2, #16\n\t"
                   "adds r1, r1, r2\n\t"
                   "asrs r4, r4, #16\n\t"
                   "adds r1, r1, r4\n\t"
                   "pop {r4, r5, pc}");
}
#else
/* A source file may not be empty. */
typedef int32_t iqfoc_arm_muls_not_needed;
#endif

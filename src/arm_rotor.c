/*
 * The rotor's polynomials on cores that multiply to 32 bits (include/iqfoc/target/arm_muls.h); elsewhere this
 * file holds nothing.
 */
#include "iqfoc/rotor.h"

#ifdef IQFOC_TARGET_ARM_MULS_H

/* A step of Horner's rule: p becomes the coefficient at `offset` and the high word of p v. r2, r3: v's halves. */
#define HORNER(p, offset)                                                                                    \
    "uxth r6, " p "\n\t"                                                                                     \
    "asrs " p ", " p ", #16\n\t"                                                                             \
    "movs r7, r6\n\t"                                                                                        \
    "muls r7, r3\n\t"                                                                                        \
    "lsrs r7, r7, #16\n\t"                                                                                   \
    "muls r6, r2\n\t"                                                                                        \
    "adds r7, r7, r6\n\t"                                                                                    \
    "movs r6, " p "\n\t"                                                                                     \
    "muls r6, r3\n\t"                                                                                        \
    "adds r7, r7, r6\n\t"                                                                                    \
    "asrs r7, r7, #16\n\t"                                                                                   \
    "muls " p ", r2\n\t"                                                                                     \
    "adds " p ", " p ", r7\n\t"                                                                              \
    "ldr r7, [r1, #" offset "]\n\t"                                                                          \
    "adds " p ", " p ", r7\n\t"

/*
 * P1 and P2 of iqfoc_rotor_shape to the bit.
 *
 * v is the square of turns = h 2^12 + l without its last 16 bits: h^2 2^8 + ((h l + (l^2 >> 13)) >> 3).
 *
 * Range: |speed| <= 2^24/3 + 1, so |h| <= 1366 and v <= 477218760: its halves are vh <= 7281 and vl. With p = ph
 * 2^16 + pl the cross products are pl vh < 2^29 and ph vl. No p that is multiplied is below -1766234468, so that
 * ph vl >= -26951 65535 > -2^31, to which nothing negative is added; nor above 871599137 + 2^27, so that ph vl
 * with the rest is below 2^31.
 */
__attribute__((naked)) int64_t iqfoc_arm_rotor(__attribute__((unused)) int32_t speed,
                                               __attribute__((unused)) const int32_t *poly)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, r6, r7, lr}\n\t"
                   "asrs r2, r0, #12\n\t"
                   "lsls r3, r0, #20\n\t"
                   "lsrs r3, r3, #20\n\t"
                   "movs r4, r3\n\t"
                   "muls r4, r4\n\t"
                   "lsrs r4, r4, #13\n\t"
                   "muls r3, r2\n\t"
                   "adds r3, r3, r4\n\t"
                   "asrs r3, r3, #3\n\t"
                   "muls r2, r2\n\t"
                   "lsls r2, r2, #8\n\t"
                   "adds r2, r2, r3\n\t" /* v */
                   "uxth r3, r2\n\t"
                   "lsrs r2, r2, #16\n\t"
                   "ldr r0, [r1, #32]\n\t"
                   "ldr r4, [r1, #36]\n\t" /* clang-format off */
                   HORNER("r0", "24") HORNER("r4", "28") HORNER("r0", "16") HORNER("r4", "20")
                   HORNER("r0", "8") HORNER("r4", "12") HORNER("r0", "0") HORNER("r4", "4") /* clang-format on */
                   "movs r1, r4\n\t"
                   "pop {r4, r5, r6, r7, pc}");
}
#else
/* A source file may not be empty. */
typedef int32_t iqfoc_arm_rotor_not_needed;
#endif

/*
 * Sine and cosine on cores that multiply to 32 bits (include/iqfoc/target/arm_muls.h); elsewhere this file
 * holds nothing.
 */
#include "iqfoc/target/detect.h"

#include <stdint.h>

#if IQFOC_TARGET_HAS_ARM_MULS
#include "iqfoc/iq24_sincos.h"

/* The polynomials below have these coefficients' halves as numbers; where they are others, this is no array. */
typedef int32_t iqfoc_arm_sincos_has_the_coefficients
    [IQ24_ROTATE_S1 == 1686629703 && IQ24_ROTATE_S3 == 41 * 65536 + 22067 && IQ24_ROTATE_C2 == 82792242 &&
             IQ24_ROTATE_C4 == 65536 + 957 && IQ24_SINE_CELLS == 64
         ? 1
         : -1];

/*
 * iq24_sincos_q30_inline to the bit, by the same steps; only the products are taken apart as their factors
 * allow. The rest is 2^14 (4 k + e) with |k| <= 2^15 and e = 0 ... 3.
 *
 *     square = k^2 + (e (8 k + e) >> 4)
 *     high word of q a positive constant: h 2^16 + l, q = qh 2^16 + ql with qh <= 2^14: each cross product and
 *         their sum fit 32 bits, and floors of floors are the floor of the whole
 *     sin_d = k ah + (((k al + (e al >> 2)) >> 2) + 2^12 e ah) >> 14
 *
 * Range: square <= 2^30. q + qh 957 + 956 < 2^31; qh 22067 + ql 41 + 22066 < 2^29. a = S1 - (h < 2^20): ah <=
 * 25735. |k al| <= 2^15 65535, and what is added to it is positive and below 49152: from -2^31 to 32767 65535 +
 * 49151 < 2^31. A quarter of that and 2^12 3 25735 are below 2^30. b = h - C2 has bh >= -1264, and qh bl < 2^30.
 *
 * The rotation has signed low halves, |x| <= 2^15, dh <= 12866 of sin_d and |mh| <= 318 of minus_versin_d. No
 * entry of the table has the low half -2^15 (tests/unit/library/test_iq24_math.c), so that cl dl + sl ml is at most
 * 2^16 32767 in size. The middle products: 32767 12866 + 2^15 (|ch| + |sh| <= 2^14.5 + 1) + 32767 318 + 2^16 <
 * 2^31.
 */
__attribute__((naked)) int64_t iqfoc_arm_sincos_q30(__attribute__((unused)) int32_t turns)
{
    __asm volatile(".syntax unified\n\t"
                   "push {r4, r5, r6, r7, lr}\n\t"
                   "lsls r1, r0, #14\n\t"
                   "asrs r1, r1, #16\n\t" /* k */
                   "lsls r2, r0, #30\n\t"
                   "lsrs r2, r2, #30\n\t" /* e */
                   "lsls r3, r1, #3\n\t"
                   "adds r3, r3, r2\n\t"
                   "muls r3, r2\n\t"
                   "asrs r3, r3, #4\n\t"
                   "movs r4, r1\n\t"
                   "muls r4, r4\n\t"
                   "adds r3, r3, r4\n\t" /* q, the square */
                   /* The tabulated angle: 64 cells of 2^18, the nearest, modulo a turn. */
                   "lsls r0, r0, #8\n\t"
                   "ldr r4, =0x02000000\n\t"
                   "adds r0, r0, r4\n\t"
                   "lsrs r0, r0, #26\n\t"
                   "lsls r0, r0, #2\n\t"
                   "ldr r4, =iq24_sine_q30\n\t"
                   "adds r0, r0, r4\n\t"
                   "uxth r4, r3\n\t"      /* ql */
                   "lsrs r5, r3, #16\n\t" /* qh */
                   /* b: the high word of q C4, less C2. */
                   "ldr r6, =957\n\t"
                   "movs r7, r4\n\t"
                   "muls r7, r6\n\t"
                   "lsrs r7, r7, #16\n\t"
                   "muls r6, r5\n\t"
                   "adds r6, r6, r7\n\t"
                   "adds r6, r6, r3\n\t"
                   "lsrs r6, r6, #16\n\t"
                   "ldr r7, =82792242\n\t"
                   "subs r6, r6, r7\n\t"
                   /* m: the high word of q b. */
                   "uxth r7, r6\n\t"
                   "asrs r6, r6, #16\n\t"
                   "movs r3, r4\n\t"
                   "muls r3, r7\n\t"
                   "lsrs r3, r3, #16\n\t"
                   "muls r7, r5\n\t"
                   "adds r3, r3, r7\n\t"
                   "movs r7, r4\n\t"
                   "muls r7, r6\n\t"
                   "adds r3, r3, r7\n\t"
                   "asrs r3, r3, #16\n\t"
                   "muls r6, r5\n\t"
                   "adds r3, r3, r6\n\t"
                   /* a: S1 less the high word of q S3. */
                   "ldr r6, =22067\n\t"
                   "movs r7, r4\n\t"
                   "muls r7, r6\n\t"
                   "lsrs r7, r7, #16\n\t"
                   "muls r6, r5\n\t"
                   "adds r6, r6, r7\n\t"
                   "movs r7, #41\n\t"
                   "muls r4, r7\n\t"
                   "adds r6, r6, r4\n\t"
                   "lsrs r6, r6, #16\n\t"
                   "muls r5, r7\n\t"
                   "adds r5, r5, r6\n\t"
                   "ldr r6, =1686629703\n\t"
                   "subs r5, r6, r5\n\t"
                   /* d: the high word of the rest times a. */
                   "uxth r6, r5\n\t"
                   "lsrs r5, r5, #16\n\t"
                   "movs r7, r6\n\t"
                   "muls r7, r2\n\t"
                   "lsrs r7, r7, #2\n\t"
                   "muls r6, r1\n\t"
                   "adds r6, r6, r7\n\t"
                   "asrs r6, r6, #2\n\t"
                   "muls r2, r5\n\t"
                   "lsls r2, r2, #12\n\t"
                   "adds r6, r6, r2\n\t"
                   "asrs r6, r6, #14\n\t"
                   "muls r1, r5\n\t"
                   "adds r1, r1, r6\n\t"
                   /* Halves: dh r1, dl r2, mh r3, ml r4, sh lr, sl ip, ch r5, cl r6; s and c on the stack. */
                   "sxth r2, r1\n\t"
                   "subs r1, r1, r2\n\t"
                   "asrs r1, r1, #16\n\t"
                   "sxth r4, r3\n\t"
                   "subs r3, r3, r4\n\t"
                   "asrs r3, r3, #16\n\t"
                   "ldr r5, [r0]\n\t"
                   "ldr r6, [r0, #64]\n\t"
                   "push {r5, r6}\n\t"
                   "sxth r7, r5\n\t"
                   "subs r5, r5, r7\n\t"
                   "asrs r5, r5, #16\n\t"
                   "mov ip, r7\n\t"
                   "mov lr, r5\n\t"
                   "sxth r7, r6\n\t"
                   "subs r5, r6, r7\n\t"
                   "asrs r5, r5, #16\n\t"
                   "movs r6, r7\n\t"
                   /* s + (c d + s m >> 34) */
                   "movs r0, r6\n\t"
                   "muls r0, r2\n\t"
                   "mov r7, ip\n\t"
                   "muls r7, r4\n\t"
                   "adds r0, r0, r7\n\t"
                   "asrs r0, r0, #16\n\t"
                   "movs r7, r6\n\t"
                   "muls r7, r1\n\t"
                   "adds r0, r0, r7\n\t"
                   "movs r7, r5\n\t"
                   "muls r7, r2\n\t"
                   "adds r0, r0, r7\n\t"
                   "mov r7, ip\n\t"
                   "muls r7, r3\n\t"
                   "adds r0, r0, r7\n\t"
                   "mov r7, lr\n\t"
                   "muls r7, r4\n\t"
                   "adds r0, r0, r7\n\t"
                   "asrs r0, r0, #16\n\t"
                   "movs r7, r5\n\t"
                   "muls r7, r1\n\t"
                   "adds r0, r0, r7\n\t"
                   "mov r7, lr\n\t"
                   "muls r7, r3\n\t"
                   "adds r0, r0, r7\n\t"
                   "asrs r0, r0, #2\n\t"
                   "ldr r7, [sp]\n\t"
                   "adds r0, r0, r7\n\t"
                   "str r0, [sp]\n\t"
                   /* c + (c m - s d >> 34) */
                   "movs r0, r6\n\t"
                   "muls r0, r4\n\t"
                   "mov r7, ip\n\t"
                   "muls r7, r2\n\t"
                   "subs r0, r0, r7\n\t"
                   "asrs r0, r0, #16\n\t"
                   "muls r6, r3\n\t"
                   "adds r0, r0, r6\n\t"
                   "muls r4, r5\n\t"
                   "adds r0, r0, r4\n\t"
                   "mov r7, ip\n\t"
                   "muls r7, r1\n\t"
                   "subs r0, r0, r7\n\t"
                   "mov r7, lr\n\t"
                   "muls r2, r7\n\t"
                   "subs r0, r0, r2\n\t"
                   "asrs r0, r0, #16\n\t"
                   "muls r5, r3\n\t"
                   "adds r0, r0, r5\n\t"
                   "muls r1, r7\n\t"
                   "subs r0, r0, r1\n\t"
                   "asrs r2, r0, #2\n\t"
                   "pop {r0, r1}\n\t"
                   "adds r1, r1, r2\n\t"
                   "pop {r4, r5, r6, r7, pc}\n\t"
                   ".ltorg");
}
#else
/* A source file may not be empty. */
typedef int32_t iqfoc_arm_sincos_not_needed;
#endif

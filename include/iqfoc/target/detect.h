/* The compiler's target, from its own architecture macros: 1 or 0 for each header of this folder. */
#ifndef IQFOC_TARGET_DETECT_H
#define IQFOC_TARGET_DETECT_H

/*
 * SMULL, SMLAL and SSAT: in Thumb code from Armv7-M on and in every core with Thumb-2
 * (__ARM_ARCH_ISA_THUMB is 2), in 32-bit Arm code from Armv6 on. Not in Armv6-M and Armv8-M Baseline
 * (Cortex-M0, M0+, M1, M23), whose Thumb is 1.
 */
#if defined(__GNUC__) && defined(__arm__) &&                                                                 \
    ((defined(__thumb__) && defined(__ARM_ARCH_ISA_THUMB) && __ARM_ARCH_ISA_THUMB >= 2) ||                   \
     (!defined(__thumb__) && defined(__ARM_ARCH) && __ARM_ARCH >= 6))
#define IQFOC_TARGET_HAS_ARM_SMULL 1
#else
#define IQFOC_TARGET_HAS_ARM_SMULL 0
#endif

/*
 * Thumb without a multiply longer than 32 bits: Cortex-M0, M0+, M1, M23. From Armv6 on, which brought UXTH, and
 * little-endian, as a product's halves are returned low word first: ARM7TDMI, ARM9 and big-endian get plain C.
 */
#if defined(__GNUC__) && defined(__arm__) && defined(__thumb__) && !IQFOC_TARGET_HAS_ARM_SMULL &&            \
    defined(__ARM_ARCH) && __ARM_ARCH >= 6 && !defined(__ARMEB__)
#define IQFOC_TARGET_HAS_ARM_MULS 1
#else
#define IQFOC_TARGET_HAS_ARM_MULS 0
#endif

/* RV32 with the multiply extension: MUL and MULH. */
#if defined(__GNUC__) && defined(__riscv) && defined(__riscv_mul) && __riscv_xlen == 32
#define IQFOC_TARGET_HAS_RV32_MULH 1
#else
#define IQFOC_TARGET_HAS_RV32_MULH 0
#endif

/* TI's C28x, by TI's compiler. */
#if defined(__TMS320C28XX__) || defined(__TMS320C2000__)
#define IQFOC_TARGET_HAS_C28X 1
#else
#define IQFOC_TARGET_HAS_C28X 0
#endif

#endif

/*
 * IQ24's hooks for RV32 with the multiply extension (M or Zmmul); chosen by target/choose.h.
 *
 * The plain product of two widened factors is what gcc and clang make MUL and MULH of. Named in assembler
 * instead, they cost the sample's way through the interrupts up to 2 % more and the finite set 13 % (gcc
 * 12.2): the compiler can no longer drop the half that nobody reads.
 */
#ifndef IQFOC_TARGET_RV32_MULH_H
#define IQFOC_TARGET_RV32_MULH_H

#include "detect.h"

#if !IQFOC_TARGET_HAS_RV32_MULH
#error                                                                                                       \
    "iqfoc/target/rv32_mulh.h is for RV32 with the multiply extension (-march=rv32im); this compiler targets another core: leave IQFOC_TARGET_HEADER undefined"
#endif

#include <stdint.h>

#define IQ24_MUL64(a, b) ((int64_t)(a) * (int64_t)(b))

/* A branch that is taken costs up to three cycles (cv32e40p, docs/bench.md), one that is not taken a single cycle. */
#define IQ24_RARE(condition) (__builtin_expect((condition), 0) != 0)

/*
 * Without it gcc 12.2 (-O2) loads all gains of the controller ahead of the prediction, has no register left for them and
 * stores them on the stack: 15 cycles more in a valley on cv32e40p (docs/bench.md).
 */
#define IQ24_LOAD_FROM_HERE() __asm volatile("" : : : "memory")

#endif

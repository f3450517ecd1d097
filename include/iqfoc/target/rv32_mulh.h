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

#endif

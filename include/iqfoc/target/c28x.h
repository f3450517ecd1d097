/*
 * IQ24's hooks for TI's C28x with TI's compiler; chosen by target/choose.h. Written after TI's manuals
 * and never run by this project, which has no such compiler.
 *
 * The compiler makes IMPYL and QMPYL, the low and the high half of a 32 by 32 bit product, of exactly
 * this form: both factors widened where they are multiplied. It needs the ABI with a 64-bit double
 * (--abi=eabi) for the constants: iq24.h refuses the other.
 */
#ifndef IQFOC_TARGET_C28X_H
#define IQFOC_TARGET_C28X_H

#include "detect.h"

#if !IQFOC_TARGET_HAS_C28X
#error                                                                                                       \
    "iqfoc/target/c28x.h is for TI's C28x; this compiler targets another core: leave IQFOC_TARGET_HEADER undefined"
#endif

#include <stdint.h>

#define IQ24_MUL64(a, b) ((int64_t)(a) * (int64_t)(b))

#endif

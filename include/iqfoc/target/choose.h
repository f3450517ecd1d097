/*
 * The target's own way of IQ24's hooks (iq24.h), chosen by the compiler's architecture macros. A core
 * that is not named here gets plain C, which gives the same bits.
 */
#ifndef IQFOC_TARGET_CHOOSE_H
#define IQFOC_TARGET_CHOOSE_H

#include "detect.h"

#if IQFOC_TARGET_HAS_ARM_SMULL
#include "arm_smull.h"
#elif IQFOC_TARGET_HAS_ARM_MULS
#include "arm_muls.h"
#elif IQFOC_TARGET_HAS_RV32_MULH
#include "rv32_mulh.h"
#elif IQFOC_TARGET_HAS_C28X
#include "c28x.h"
#endif

#endif

/*
 * The target header of the test: port/c2000/iqfoc_tmu.h with models in place of the compiler's intrinsics.
 */
#ifndef TMU_ON_HOST_H
#define TMU_ON_HOST_H

float model_sine(float turns);
float model_cosine(float turns);
float model_quotient(float numerator, float denominator);

#define __sinpuf32(turns) model_sine(turns)
#define __cospuf32(turns) model_cosine(turns)
#define __divf32(a, b)    model_quotient(a, b)

#include "iqfoc_tmu.h"

#endif

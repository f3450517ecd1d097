/*
 * What the models of the TMU add to the exact result before it is rounded to float: 0 unless a test sets it.
 */
#ifndef TMU_MODEL_H
#define TMU_MODEL_H

#include "tmu_on_host.h"

extern double model_added_lsb;  /* to a sine or cosine, in LSB of 2^-24 */
extern double model_added_part; /* to a quotient, as a part of it */

#endif

/*
 * Models of the intrinsics for the TMU (tmu_on_host.h).
 */
#include "model.h"

#include <math.h>

#define TAU 6.28318530717958647693
#define LSB (1.0 / 16777216.0)

double model_added_lsb;
double model_added_part;

/* Rounded to float after the error is added: e is |model_added_lsb| + 0.5 LSB. */
float model_sine(float turns)
{
    return (float)(sin(TAU * (double)turns) + model_added_lsb * LSB);
}

float model_cosine(float turns)
{
    return (float)(cos(TAU * (double)turns) + model_added_lsb * LSB);
}

float model_quotient(float numerator, float denominator)
{
    return (float)((double)numerator / (double)denominator * (1.0 + model_added_part));
}

/* Common parts of the predictors' tests: vectors drawn at random, and as complex numbers. */
#ifndef TESTS_UNIT_REFERENCE_VECTORS_H
#define TESTS_UNIT_REFERENCE_VECTORS_H

#include "reference.h"

#include "iqfoc/transform.h"

#include <complex.h>

static inline int32_t to_fixed(double x, int bits)
{
    return (int32_t)lround(ldexp(x, bits));
}

static inline double complex complex_of_ab(iqfoc_ab_t v)
{
    return to_double(v.alpha) + I * to_double(v.beta);
}

static inline double complex complex_of_dq(iqfoc_dq_t v)
{
    return to_double(v.d) + I * to_double(v.q);
}

/* Each component uniform in [-reach, reach]. */
static inline iqfoc_ab_t random_ab_in_square(uint64_t *seed, double reach)
{
    const iqfoc_ab_t v = {random_iq24(seed, -reach, reach), random_iq24(seed, -reach, reach)};
    return v;
}

/* Angle and length uniform. */
static inline iqfoc_ab_t random_ab_in_disc(uint64_t *seed, double length)
{
    const double angle = uniform(seed, 0.0, TWO_PI);
    const double r = uniform(seed, 0.0, length);
    const iqfoc_ab_t v = {to_iq24(r * cos(angle)), to_iq24(r * sin(angle))};
    return v;
}

static inline iqfoc_dq_t random_dq_in_disc(uint64_t *seed, double length)
{
    const iqfoc_ab_t v = random_ab_in_disc(seed, length);
    const iqfoc_dq_t in_rotor_frame = {v.alpha, v.beta};
    return in_rotor_frame;
}

#endif

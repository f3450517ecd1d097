/*
 * Vectors as complex numbers, for formulas in the papers' notation: stationary frame, rotor frame if a name ends in _dq. Types and
 * constants are those of vector.h.
 */
#ifndef SIM_HOST_BASE_VECTOR_COMPLEX_H
#define SIM_HOST_BASE_VECTOR_COMPLEX_H

#include "vector.h"

#include <complex.h>

/* re + j im. (C11's CMPLX is missing in clang 14; for finite values this is the same.) */
static inline double complex vec_complex(double re, double im)
{
    return re + im * I;
}

/* e^{j angle}. */
static inline double complex vec_turn(double angle_rad)
{
    return vec_complex(cos(angle_rad), sin(angle_rad));
}

static inline double complex vec_complex_ab(vec_ab v)
{
    return vec_complex(v.alpha, v.beta);
}

static inline double complex vec_complex_dq(vec_dq v)
{
    return vec_complex(v.d, v.q);
}

static inline vec_ab vec_ab_of(double complex x)
{
    const vec_ab v = {creal(x), cimag(x)};
    return v;
}

static inline vec_dq vec_dq_of(double complex x)
{
    const vec_dq v = {creal(x), cimag(x)};
    return v;
}

/* Clarke, amplitude invariant. */
static inline double complex vec_complex_of_phases(const double abc[3])
{
    return vec_complex_ab(vec_from_phases(abc));
}

/* |x|^2. */
static inline double vec_square(double complex x)
{
    return creal(x) * creal(x) + cimag(x) * cimag(x);
}

#endif

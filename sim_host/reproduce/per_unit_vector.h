/*
 * Complex vectors in physical units to the firmware's per-unit vectors and back (params_host.h has the
 * scalars).
 */
#ifndef SIM_HOST_REPRODUCE_PER_UNIT_VECTOR_H
#define SIM_HOST_REPRODUCE_PER_UNIT_VECTOR_H

#include "../model/papers.h"
#include "params_host.h"

static inline iqfoc_ab_t vector_to_iq24(double complex x, double base)
{
    const iqfoc_ab_t v = {iq24_from_double(creal(x) / base), iq24_from_double(cimag(x) / base)};
    return v;
}

static inline double complex vector_from_iq24(iqfoc_ab_t v, double base)
{
    return base * papers_vector(iq24_to_double(v.alpha), iq24_to_double(v.beta));
}

static inline double complex dq_from_iq24(iqfoc_dq_t v, double base)
{
    return base * papers_vector(iq24_to_double(v.d), iq24_to_double(v.q));
}

#endif

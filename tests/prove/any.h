/*
 * Values with a known range only: the numbers that a function's documented precondition allows. Frama-C's EVA
 * computes with all of them at once.
 */
#ifndef TESTS_PROVE_ANY_H
#define TESTS_PROVE_ANY_H

#include "iqfoc/transform.h"

#include "__fc_builtin.h"

static inline int32_t any_within(int32_t low, int32_t high)
{
    return Frama_C_interval(low, high);
}

static inline iq24_t any(void)
{
    return any_within(IQ24_MIN, IQ24_MAX);
}

static inline uint32_t any_count(uint32_t low, uint32_t high)
{
    return Frama_C_unsigned_int_interval(low, high);
}

static inline bool any_bool(void)
{
    return any_within(0, 1) != 0;
}

static inline iqfoc_ab_t any_ab(iq24_t limit)
{
    const iqfoc_ab_t ab = {any_within(-limit, limit), any_within(-limit, limit)};
    return ab;
}

static inline iqfoc_dq_t any_dq(iq24_t limit)
{
    const iqfoc_dq_t dq = {any_within(-limit, limit), any_within(-limit, limit)};
    return dq;
}

static inline iqfoc_abc_t any_abc(iq24_t low, iq24_t high)
{
    const iqfoc_abc_t abc = {any_within(low, high), any_within(low, high), any_within(low, high)};
    return abc;
}

static inline iq24_sincos_t any_sincos(void)
{
    const iq24_sincos_t sc = {any_within(-IQ24_ONE, IQ24_ONE), any_within(-IQ24_ONE, IQ24_ONE)};
    return sc;
}

#endif

/*
 * Common parts of the library's tests: conversion, a seeded generator, and the largest error against a
 * double-precision reference. The error is printed, so that the bounds in the headers keep their source.
 */
#ifndef TESTS_UNIT_REFERENCE_H
#define TESTS_UNIT_REFERENCE_H

#include "iqfoc/iq24.h"

#include "unity.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

#define TWO_PI 6.28318530717958647692

/* Thins a sweep where double precision is slow: on an emulated core. 1 is the full test. */
#ifndef IQFOC_TEST_STRIDE
#define IQFOC_TEST_STRIDE 1
#endif

static inline double to_double(iq24_t x)
{
    return (double)x / 16777216.0;
}

static inline iq24_t to_iq24(double x)
{
    return (iq24_t)lround(x * 16777216.0);
}

/* splitmix64: the state walks by an odd constant, the output is mixed twice. */
static inline uint64_t random_bits(uint64_t *state)
{
    *state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Uniform in [low, high). */
static inline double uniform(uint64_t *seed, double low, double high)
{
    return low + (high - low) * (double)(random_bits(seed) >> 11) / 9007199254740992.0;
}

/* Uniform in [low, high]. */
static inline iq24_t random_iq24(uint64_t *state, double low, double high)
{
    const double unit = (double)(random_bits(state) >> 11) / 9007199254740992.0;
    return to_iq24(low + (high - low) * unit);
}

/* The largest error of one quantity, in LSB. */
typedef struct worst {
    const char *what;
    double lsb;
} worst;

static inline void worst_add(worst *w, iq24_t got, double want)
{
    const double lsb = fabs((double)got - want * 16777216.0);
    if (lsb > w->lsb) {
        w->lsb = lsb;
    }
}

/* Fails above the bound stated in the header, and when the bound is more than twice what is seen: then it
 * says nothing. */
static inline void worst_check(const worst *w, double bound_lsb)
{
    printf("  %-40s worst %.3f LSB, stated %.2f\n", w->what, w->lsb, bound_lsb);
    TEST_ASSERT_TRUE_MESSAGE(w->lsb <= bound_lsb, w->what);
    TEST_ASSERT_TRUE_MESSAGE(w->lsb >= 0.5 * bound_lsb, w->what);
}

#endif

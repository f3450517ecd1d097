/* What the two predictions by flux have in common (flux_predictor.c, flux_map.c). */
#ifndef IQFOC_SRC_FLUX_STEP_H
#define IQFOC_SRC_FLUX_STEP_H

#include "iqfoc/iq24_math.h"
#include "iqfoc/vector.h"

/*
 * Flux after a cycle with the acting voltage and the drop of a current i over r. Every sum saturates. Not inline: each of the two calls
 * it twice.
 */
static iqfoc_ab_t flux_after_cycle(iq24_t r, iqfoc_ab_t flux, iqfoc_ab_t acting, iqfoc_ab_t i)
{
    const iqfoc_ab_t next = {iq24_add_sat(flux.alpha, iq24_sub_sat(acting.alpha, iq24_mul_round(r, i.alpha))),
                             iq24_add_sat(flux.beta, iq24_sub_sat(acting.beta, iq24_mul_round(r, i.beta)))};
    return next;
}

/* The mean of two currents, rounded down. */
static inline iqfoc_ab_t flux_mean_current(iqfoc_ab_t first, iqfoc_ab_t last)
{
    const iqfoc_ab_t mean = {iq24_wrap(iq24_asr64((int64_t)first.alpha + last.alpha, 1)),
                             iq24_wrap(iq24_asr64((int64_t)first.beta + last.beta, 1))};
    return mean;
}

#endif

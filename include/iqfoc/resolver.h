/*
 * Electrical angle from the two voltages of a resolver or a sine/cosine encoder, and a check of their amplitude.
 *
 *     x = gain_cos (cos - offset_cos),   y = gain_sin (sin - offset_sin)
 *     theta = ratio atan2(y, x) - theta_0                                                          turns
 *
 * Sample both voltages at the same instant, at the excitation's peak. A broken wire, a short circuit or a lost
 * excitation changes x^2 + y^2, which is 1 in a healthy sensor. The functions only read their arguments: any context
 * may call them.
 */
#ifndef IQFOC_RESOLVER_H
#define IQFOC_RESOLVER_H

#include "error.h"
#include "iq24_math.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Any scale of the voltages in which the gains make their amplitude 1. */
typedef struct iqfoc_resolver {
    iq24_t offset_sin; /* -4 ... 4 */
    iq24_t offset_cos;
    iq24_t gain_sin; /* 1/16 ... 16 */
    iq24_t gain_cos;
    iq24_t amplitude_min; /* sqrt(x^2 + y^2) below this value is a fault: 0 < min < max */
    iq24_t amplitude_max; /* sqrt(x^2 + y^2) above this value is a fault: <= 2 */
    iq24_t ratio;         /* electrical turns in a turn of the signals: whole, 1 ... 64; no fraction bits */
    iq24_t theta_0;       /* ratio atan2(y, x) at electrical angle 0, turns: -1 ... 1 */
} iqfoc_resolver_t;

typedef struct iqfoc_resolver_angle {
    iq24_t theta; /* electrical, turns: -33 ... 33 */
    bool valid;   /* the amplitude is within its limits */
} iqfoc_resolver_angle_t;

/* IQFOC_ERROR_RESOLVER: a field out of its range. Once; iqfoc_resolver_read relies on it. */
iqfoc_error_t iqfoc_resolver_check(const iqfoc_resolver_t *resolver);

/*
 * sin, cos: any. Largest error of 400000 drawn: of theta ratio times 0.64 LSB, and what a rounding of 0.5
 * LSB of x and y turns the vector by; of the amplitudes' limits 1.3 LSB.
 */
iqfoc_resolver_angle_t iqfoc_resolver_read(const iqfoc_resolver_t *resolver, iq24_t sin, iq24_t cos);

#ifdef __cplusplus
}
#endif

#endif

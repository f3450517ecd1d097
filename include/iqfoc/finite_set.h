/*
 * Finite-control-set predictive current control, without a modulator. For each control interval it chooses the
 * inverter state, one of eight, that begins the best sequence over a prediction horizon of 1 to 3 intervals.
 *
 *     cost = sum over the horizon of |i_ref - i|^2 + weight * (legs that switch)
 *
 * It predicts the current by the same iqfoc_exact_t as deadbeat control, first over the interval that begins now,
 * whose state is already decided. The search goes depth first and leaves a branch as soon as it costs more than the
 * best sequence found, which never changes the result. Of equally good sequences the first in the order of the states
 * is kept.
 */
#ifndef IQFOC_FINITE_SET_H
#define IQFOC_FINITE_SET_H

#include "predictor_exact.h"
#include "transform.h"
#include "valley_reference.h"

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_FINITE_SET_STATES  8
#define IQFOC_FINITE_SET_HORIZON 3

/* A state: bit 0 is set if leg A is high, bit 1 for B, bit 2 for C. */

typedef struct iqfoc_finite_set {
    iqfoc_exact_t model; /* over one control interval, at the present speed */
    iqfoc_valley_reference_t reference;
    iq24_t weight;   /* cost of one leg's switching, per-unit current squared: 0 ... 1 */
    int32_t horizon; /* 1 ... 3; another value counts as the nearer of these */
} iqfoc_finite_set_t;

/*
 * The state for the interval after the one that begins now. From the interrupt at the start of an interval.
 *
 * i: sample at the start of this interval, |component| <= 15. state_now: the state of this interval, 0 ... 7. i_ref:
 * reference of the mean current, rotor frame, |component| <= 20. theta: at the start of this interval. speed: of the
 * speed that `set` was made for, per interval. u_dc: per unit, 0 ... 2. nodes: if not NULL, the number of predicted
 * currents is added to it: 8 for a horizon of 1, at most 8 + 64 + 512.
 *
 * Ranges: |i| <= 15 + 21.4 + 20.8 after this interval; each later one adds at most as much, to 121 at a
 * horizon of 3, so no prediction wraps. A component of an error counts as at most 32, so a cost is at most
 * 3 (2 * 32^2 + 3) = 6153, within the accumulator's 32768.
 */
int32_t iqfoc_finite_set_choose(const iqfoc_finite_set_t *set, iqfoc_ab_t i, int32_t state_now,
                                iqfoc_dq_t i_ref, iq24_t theta, iq24_t speed, iq24_t u_dc, uint32_t *nodes);

/* Its voltage vector for a DC link in per unit, |u_dc| <= 32: error 0.7 LSB. */
iqfoc_ab_t iqfoc_finite_set_voltage(int32_t state, iq24_t u_dc);

#ifdef __cplusplus
}
#endif

#endif

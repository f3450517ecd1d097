/*
 * Adapts L_q of the observer (iqfoc/observer.h) from the steps of the current, for machines whose L_q is uncertain or
 * changes with the load. A wrong L_q turns the observed angle by dL i_q/psi_f. Nothing in the library calls it.
 *
 * The rotor's angle cannot jump, but the angle of the active flux jumps with i_q if L_q is wrong. The error e of the
 * phase-locked loop is then -dL/(2 pi psi_f) times x: i_q behind the same loop's filter,
 *
 *     x = i_q - (s + v),   s += v + k1 x,   v += k2 x
 *
 * So each cycle with |x| >= least takes a step of the normalised gradient,
 *
 *     l_q += gain 2 pi psi_f e x/(x^2 + least^2),   held to low ... high
 *
 * With e exactly as above, a step takes dL times 1 - gain x^2/(x^2 + least^2): for 0 < gain <= 1 it never grows.
 *
 * L_q can be identified at any speed at which the observer is locked, from changes of i_q that last fewer cycles than
 * the loop's 1/w T. A constant or slow current, or a small step, holds l_q. Noise n of i_q draws l_q down by about its
 * share n^2/x^2; with least >= 10 n this is below 1 %. A rotor that accelerates within the step by a turns per cycle^2
 * draws l_q by 2 pi psi_f a/(k2 x) at most.
 *
 *     valley:  iqfoc_observer_step(&observer, u, i_mean, i);
 *              iqfoc_observer_inductance_step(&inductance, &observer, i);
 *
 * observer.config is &inductance.adapted then. R and psi_f: iqfoc/adapt.h.
 */
#ifndef IQFOC_OBSERVER_INDUCTANCE_H
#define IQFOC_OBSERVER_INDUCTANCE_H

#include "observer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Per unit, IQ24. */
typedef struct iqfoc_observer_inductance_config {
    iq24_t gain;  /* 0 < gain <= 1; 0.05 is usual */
    iq24_t least; /* of |x|, 1/16 ... 1 of the rated peak current; 0.08 is usual */
    iq24_t low;   /* of l_q, above 0 and at most the nominal one */
    iq24_t high;  /* at least the nominal one, at most 8; both within 4 of l_d */
} iqfoc_observer_inductance_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_observer_inductance {
    const iqfoc_observer_inductance_config_t *config;
    iqfoc_observer_config_t adapted; /* the observer's, with l_q adapted; k_q and skew stay nominal */
    iq24_t level;                    /* s: held to +-16 */
    iq24_t slope;                    /* v: held to +-8 */
    bool follows;                    /* level and slope are those of a locked observer */
} iqfoc_observer_inductance_t;

/*
 * Checks both, copies `nominal` to `adapted`, and leaves the current's filter to the first step. config must outlive the
 * object. Errors: those of iqfoc_observer_check, IQFOC_ERROR_OBSERVER. Ahead of the first interrupt.
 */
iqfoc_error_t iqfoc_observer_inductance_init(iqfoc_observer_inductance_t *inductance,
                                             const iqfoc_observer_inductance_config_t *config,
                                             const iqfoc_observer_config_t *nominal);

/*
 * After each step of the observer, with the same i: |component| <= 15.9, stationary frame; i_q is held to +-4. Changes
 * adapted.l_q if the observer is locked and |x| >= least. With `saturation` in the observer, l_q is that at zero current.
 * From the observer's context. Largest error of a step, of 400000 drawn: 1e-5 of the step, and 2 + gain
 * (psi_f + 2)/(2 least) LSB.
 *
 * Range: |i_q| <= 4, |s| <= 16 and |v| <= 8, so |x| <= 28 is held to +-8. x^2 + least^2 is within 1/128 ... 65, and the
 * quotient within 1/(2 least) = 8. 2 pi psi_f |e| is held to +-8: the product with the quotient is within 64.
 */
void iqfoc_observer_inductance_step(iqfoc_observer_inductance_t *inductance, const iqfoc_observer_t *observer,
                                    iqfoc_ab_t i);

#ifdef __cplusplus
}
#endif

#endif

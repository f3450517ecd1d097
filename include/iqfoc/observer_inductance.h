/*
 * Adapts L_q of the observer (iqfoc/observer.h) from the steps of the current, for machines whose L_q is uncertain or changes with
 * the load. If l_q is wrong by dL = l_q - L_q, the observed angle is wrong by dL i_q/psi_f. Optional: no other part of the library
 * calls it.
 *
 * The rotor's angle cannot jump, but with a wrong l_q the observed angle jumps when i_q jumps. The error of the observer's
 * phase-locked loop is then e = -dL x/(2 pi psi_f). x is the error of a loop with the same k1 and k2 that tracks i_q by a level s and
 * a slope v:
 *
 *     x = i_q - (s + v),   s += v + k1 x,   v += k2 x
 *
 * Each cycle with |x| >= least and w T l_q |x| >= u_least takes a step of the normalised gradient,
 *
 *     l_q += gain 2 pi psi_f e x/(x^2 + least^2),   held to low ... high
 *
 * If e is exactly as above, a step multiplies dL by 1 - gain x^2/(x^2 + least^2): for 0 < gain <= 1, |dL| never grows.
 *
 * L_q is seen by its voltage w T l_q x of a step, w T the angle per cycle. An error v of the voltage's model that changes with the
 * current, as that of a dead time does, moves the flux by v in each cycle of the step, and the angle as dL = v/(w T x) would. So L_q
 * is wrong by about the share v/u_least at most: 10 v for u_least leaves 10 %, and holds l_q at a speed or a current at which it cannot
 * be identified. Changes of i_q must take fewer cycles than 1/(w_l T), w_l the loop's bandwidth. With a constant or slow current, or a
 * small step, l_q keeps its value. Noise n of i_q makes l_q too small by a share of about n^2/x^2; with least >= 10 n this is below 1 %.
 * A rotor that accelerates within the step by a turns per cycle^2 makes an error of l_q of 2 pi psi_f a/(k2 x) at most.
 *
 *     valley:  iqfoc_observer_step(&observer, u, i_mean, i);
 *              iqfoc_observer_inductance_step(&inductance, &observer, i);
 *
 * Set observer.config to &inductance.adapted for this. For R and psi_f: observer_resistance.h.
 */
#ifndef IQFOC_OBSERVER_INDUCTANCE_H
#define IQFOC_OBSERVER_INDUCTANCE_H

#include "observer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Per unit, IQ24. */
typedef struct iqfoc_observer_inductance_config {
    iq24_t gain;    /* 0 < gain <= 1; at most 0.3 w_l T: 0.05 with the loop's 0.16/T */
    iq24_t least;   /* smallest |x| of a step: 1/16 ... 1 of the rated peak current; 0.08 is usual */
    iq24_t u_least; /* smallest w T l_q |x| of a step: 0 ... 1; 0.003 is usual */
    iq24_t low;     /* lower limit of l_q: above 0, at most the nominal l_q */
    iq24_t high;    /* upper limit of l_q: at least the nominal one, at most 8; both limits within l_d +- 4 */
} iqfoc_observer_inductance_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_observer_inductance {
    const iqfoc_observer_inductance_config_t *config;
    iqfoc_observer_config_t adapted; /* the observer's, with l_q adapted; k_q and skew stay nominal */
    iq24_t level;                    /* s: held to +-16 */
    iq24_t slope;                    /* v: held to +-8 */
    bool follows;                    /* level and slope track the current of a locked observer */
} iqfoc_observer_inductance_t;

/*
 * Checks both configurations and copies `nominal` to `adapted`. The filter of the current starts with the first step. config must
 * outlive the object. Errors: IQFOC_ERROR_NULL, a pointer is missing; those of iqfoc_observer_check; IQFOC_ERROR_OBSERVER, a value of
 * config is out of its range. Call it before the first interrupt.
 */
iqfoc_error_t iqfoc_observer_inductance_init(iqfoc_observer_inductance_t *inductance,
                                             const iqfoc_observer_inductance_config_t *config,
                                             const iqfoc_observer_config_t *nominal);

/*
 * Call it after each step of the observer, from the observer's context, with the same i: |component| <= 15.9, stationary frame; i_q
 * is held to +-4. Changes adapted.l_q if the observer is locked and the step is large enough. If the observer has a `saturation`, l_q is
 * the inductance at zero current. Largest error of a step, of 400000 drawn: 1e-5 of the step, and 2 + gain (psi_f + 2)/(2 least) LSB.
 *
 * Range: |i_q| <= 4, |s| <= 16 and |v| <= 8, so |x| <= 28; x is held to +-8. x^2 + least^2 is within 1/128 ... 65, and the quotient
 * within 1/(2 least) = 8. l_q |x| is within 64 and w T within 2.1; their product saturates at 128. 2 pi psi_f |e| is held to +-8: the
 * product with the quotient is within 64.
 */
void iqfoc_observer_inductance_step(iqfoc_observer_inductance_t *inductance, const iqfoc_observer_t *observer,
                                    iqfoc_ab_t i);

#ifdef __cplusplus
}
#endif

#endif

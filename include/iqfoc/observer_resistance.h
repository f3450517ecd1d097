/*
 * Adapts R and psi_f of the observer (iqfoc/observer.h) from its radial error, for drives whose winding and magnet change with the
 * temperature, and for a reversal through standstill under load. Optional: no other part of the library calls it. L_q is adapted by
 * observer_inductance.h from the other component of the error. Both may change one set.
 *
 * If r is too large by the share dr and psi_f by dp, the flux is wrong by psi_f s dr, and the radial error is
 *
 *     off/psi_f = x dr + dp
 *
 * s is the derivative of the observer's flux by dr, over psi_f. It obeys the observer's own recursion:
 *
 *     s' = s - (r/psi_f) i,   x = -d s',   y = d x s',   s = s' + g x d
 *
 * In steady state x = (r/psi_f) i_q/phi = R i_q/EMF: R shows at low speed and psi_f at high speed. With least = psi_share/r_share:
 *
 *     R is seen:      |x| >= least, |x| >= |y|                      dr -= gain off/(psi_f x),   psi += psi_f s (change of dr)
 *     psi_f is seen:  |x|, |y| < least/2, |speed| >= speed_min      dp -= gain off/psi_f
 *     otherwise:      both keep their values
 *
 * So R is seen if the EMF is below R i_q r_share/psi_share, and psi_f above twice that EMF. Without current R keeps its value.
 *
 * The change of psi moves the flux to its value for the new r. The rest of the flux error, psi_error - psi_f s dr, then obeys the
 * observer's own equation and decays, for any change of r (Zhang, Adaptive observer for multiple-input-multiple-output linear
 * time-varying systems, IEEE Trans. Autom. Control 47(3), 2002). After that, each step multiplies dr by 1 - gain and subtracts
 * gain dp/x. So |dr| never grows beyond |dp| r_share/psi_share.
 *
 *     valley:  iqfoc_observer_step(&observer, u, i_mean, i);
 *              iqfoc_observer_resistance_step(&resistance, &observer, i);
 *
 * observer.config must be the adapted set. The sample i replaces the mean current: they are phi/2 apart, which matters only at speeds
 * at which R is not seen.
 */
#ifndef IQFOC_OBSERVER_RESISTANCE_H
#define IQFOC_OBSERVER_RESISTANCE_H

#include "observer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* IQ24. The shares are of the nominal values: the uncertainty, and the bounds of the adapted values. */
typedef struct iqfoc_observer_resistance_config {
    iq24_t gain;      /* 0 < gain <= 1; 0.05 is usual */
    iq24_t r_share;   /* 1/16 ... 1/2 */
    iq24_t psi_share; /* 1/64 ... 1/4 */
} iqfoc_observer_resistance_config_t;

/* The state. All fields may be read. */
typedef struct iqfoc_observer_resistance {
    const iqfoc_observer_resistance_config_t *config;
    iqfoc_observer_config_t *adapted; /* the observer's: r and psi are written */
    iq24_t r_nominal;
    iq24_t psi_nominal;
    iq24_t r_over_psi;  /* of the nominal values */
    iq24_t psi_inverse; /* of the nominal value */
    iq24_t least;       /* psi_share/r_share */
    iq24_t r;           /* share by which r differs from the nominal one, within +-r_share */
    iq24_t psi;         /* likewise of psi, within +-psi_share */
    iqfoc_ab_t s;       /* each component within +-32 */
} iqfoc_observer_resistance_t;

/*
 * The values of `adapted` become the nominal ones. config and adapted must outlive the object. Errors: IQFOC_ERROR_NULL, a pointer is
 * missing; those of iqfoc_observer_check for `adapted` and for both ends of its bounds; IQFOC_ERROR_OBSERVER, a value of config is out
 * of its range, or r/psi_f is above 8. Call it before the first interrupt.
 */
iqfoc_error_t iqfoc_observer_resistance_init(iqfoc_observer_resistance_t *resistance,
                                             const iqfoc_observer_resistance_config_t *config,
                                             iqfoc_observer_config_t *adapted);

/*
 * Call it after each step of the observer, from the observer's context, with the same i: |component| <= 15.9, stationary frame. While
 * the observer seeks, s is 0 and both keep their values. Largest error of a step, of 400000 drawn: s 2 LSB + 3 |s'| LSB + |i| LSB; r
 * 1 LSB + gain (1 + psi_f + (3 + 3 |x| + |i|) |off/(psi_f x)|)/|x| LSB; psi 1 LSB + gain (1 + psi_f) LSB.
 *
 * Range: (r/psi_f) i is within 127.2 and is held to +-32, as s is: the difference is within 64, and the parts along and across d within
 * 45.3. off/psi_f is held to +-1, so off/(psi_f x) is within 32, as least >= 1/32. The change of r is within 1, and psi_f times it
 * times s saturates.
 */
void iqfoc_observer_resistance_step(iqfoc_observer_resistance_t *resistance, iqfoc_observer_t *observer,
                                    iqfoc_ab_t i);

#ifdef __cplusplus
}
#endif

#endif

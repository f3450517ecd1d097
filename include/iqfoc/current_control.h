/*
 * Current control in the rotor frame: PI with decoupling and back-calculation anti-windup.
 *
 *     u_d = kp_d e_d + I_d - x x_q i_q
 *     u_q = kp_q e_q + I_q + x (x_d i_d + emf),     e = i_ref - i,  x = speed in turns per cycle
 *     I  += ki e + k_aw (scale - 1) u
 *
 * where the modulator could only make scale * u of the voltage. The frame in which u acts is the caller's:
 * the cycle turns it back with the rotor angle at the middle of the span in which the voltage will stand.
 */
#ifndef IQFOC_CURRENT_CONTROL_H
#define IQFOC_CURRENT_CONTROL_H

#include "iq24_math.h"
#include "vector.h"

/* Per unit, IQ24 (iqfoc/params.h makes them). All >= 0. */
typedef struct iqfoc_current_control_gains {
    iq24_t kp_d; /* voltage per current, <= 32 */
    iq24_t kp_q; /* the same for q; differs where L_q != L_d */
    iq24_t ki_d; /* voltage per current and cycle, <= 32 */
    iq24_t ki_q;
    iq24_t anti_windup; /* k_aw: share of the missing voltage taken back per cycle, <= 1; ki/kp is the usual
                           choice */
    iq24_t x_d;         /* 2 pi L_d I_b / (T U_b): reactance at one turn per cycle, <= 96; 0: no decoupling */
    iq24_t x_q;         /* 2 pi L_q I_b / (T U_b) */
    iq24_t emf;         /* 2 pi psi_f / (T U_b): EMF at one turn per cycle, <= 96 */
} iqfoc_current_control_gains_t;

/* The integrators, per unit voltage. Zero it to reset. */
typedef struct iqfoc_current_control {
    iqfoc_dq_t integral; /* each within +-IQFOC_CURRENT_CONTROL_LIMIT */
} iqfoc_current_control_t;

/* No integrator and no output component leaves this range (per unit voltage): eight times what any DC link
 * can make. */
#define IQFOC_CURRENT_CONTROL_LIMIT IQ24(8.0)

/*
 * One step: the voltage that the controller asks for, before any limit of the inverter.
 *
 * i_ref, i: per unit, |component| <= 32. turns: speed, |turns| <= 1/3 turn per cycle. Out: per unit voltage,
 * each component held to the limit above; so is the integrator. Largest error of u against double: 0.5 LSB +
 * 0.5 LSB per unit of i (the decoupling's rounded reactance); of the integrator 0.5 LSB a step.
 */
iqfoc_dq_t iqfoc_current_control_step(iqfoc_current_control_t *control,
                                      const iqfoc_current_control_gains_t *gains, iqfoc_dq_t i_ref,
                                      iqfoc_dq_t i, iq24_t turns);

/*
 * Back-calculation: to be called after a step of which the modulator could only make scale < 1.
 * scale: 0 ... 1, as iqfoc_modulate gives it; 1 leaves the integrators as they are.
 */
void iqfoc_current_control_limited(iqfoc_current_control_t *control,
                                   const iqfoc_current_control_gains_t *gains, iqfoc_dq_t u, iq24_t scale);

#endif

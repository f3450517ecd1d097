/*
 * The exact solution of the linear machine between two switching edges.
 *
 *     L_d di_d/dt = u_d - R i_d + omega L_q i_q
 *     L_q di_q/dt = u_q - R i_q - omega (L_d i_d + psi_f)
 *
 * with constant speed and a constant voltage in the stationary frame, so that it turns backwards
 * here: u_dq(s) = e^{-j omega s} u_dq(0). The system [i_dq, u_dq, 1] is linear with constant coefficients;
 * its solution is a matrix exponential. It is evaluated by its power series to the last bit, over spans on
 * which the terms fall faster than 1/n!: there is no step size and no step error, no division by speed,
 * resistance or a difference of inductances, and the integrals of the current come from the same terms.
 */
#ifndef SIM_HOST_PLANT_PLANT_ELECTRICAL_H
#define SIM_HOST_PLANT_PLANT_ELECTRICAL_H

#include "../base/vector.h"

typedef struct electrical_linear {
    double R_ohm; /* winding and device on-resistance together */
    double L_d_H, L_q_H;
    double psi_f_Wb;
    double omega_e_rad_s;
} electrical_linear;

typedef struct electrical_state {
    vec_dq i_dq_A;
    vec_dq integral_dq_As;    /* integral of i_dq: grows by what the span adds */
    vec_ab integral_start_As; /* of the current in the rotor frame of the span's start */
} electrical_state;

/*
 * Advances the current by dt_s >= 0 from x->i_dq_A, with u_dq_V the voltage in the rotor frame at the start.
 * Adds to integral_dq_As; sets integral_start_As (turn it by the rotor's angle at the start for the
 * stationary frame).
 */
void electrical_advance(const electrical_linear *m, double dt_s, vec_dq u_dq_V, electrical_state *x);

/*
 * The same, and *seen: the current behind a first-order low-pass (plant_low_pass.h) of this bandwidth > 0, in the rotor frame of the
 * start, before and after. NULL: no low-pass.
 */
void electrical_advance_seen(const electrical_linear *m, double dt_s, vec_dq u_dq_V, electrical_state *x,
                             double bandwidth_rad_s, vec_ab *seen);

#endif

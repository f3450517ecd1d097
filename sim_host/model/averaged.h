/*
 * The averaged model of a salient permanent-magnet machine over one control cycle, without discretisation
 * error.
 *
 * Over a cycle the inverter applies a constant mean voltage in the stationary frame; the rotor turns at a
 * constant speed. In the rotor frame, with the current's flux x = (L_d i_d, L_q i_q) as state,
 *
 *     dx/dt = A x + u_dq(t) - omega psi_f (0, 1),      A = [ -R/L_d   omega ]      u_dq(t) = e^{-j omega t}
 * u_dq(0) [ -omega  -R/L_q ]
 *
 * and therefore, exactly,
 *
 *     x(T) = decay x(0) + drive u_dq(0) + push (0, -omega psi_f)
 *     decay = e^{A T},  drive = int_0^T e^{A (T-s)} e^{-j omega s} ds,  push = int_0^T e^{A s} ds.
 *
 * decay is in closed form (A is a multiple of 1 plus a matrix whose square is one); the integrals are
 * evaluated by a Gauss-Legendre rule of six points, whose error is below 1e-11 T at |omega T| = 2.1 (three
 * cycles a revolution). Nothing divides by the speed or the resistance: standstill, reverse and R = 0 are
 * ordinary points.
 */
#ifndef SIM_HOST_MODEL_AVERAGED_H
#define SIM_HOST_MODEL_AVERAGED_H

typedef struct averaged_step {
    double decay[2][2]; /* 1 */
    double drive[2][2]; /* s */
    double push[2][2];  /* s */
} averaged_step;

/* The three matrices at one speed. Needs L_d_H, L_q_H > 0 and R_ohm >= 0. */
averaged_step averaged_step_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s);

/*
 * The same for many speeds near one node: value and first two derivatives by the speed, so that a table of
 * nodes serves all rows of a recording. Within |omega - node| T <= AVERAGED_NODE_STEP / 2 the error is below
 * 1e-7 of each matrix.
 */
#define AVERAGED_NODE_STEP 0.01

typedef struct averaged_node {
    averaged_step value, slope,
        bend; /* f(node + h) = value + h slope + h^2 bend, h in units of AVERAGED_NODE_STEP/T */
} averaged_node;

averaged_node averaged_node_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s);

/* The matrices at h node steps from the node, |h| <= 0.5. */
averaged_step averaged_node_step(const averaged_node *node, double h);

#endif

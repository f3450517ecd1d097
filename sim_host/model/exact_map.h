/*
 * The one exact model of a salient machine over a span of constant speed and of a voltage that stands still
 * in the stationary frame: exact.h and the diagnosis' averaged model (averaged.h) use it. Rotor frame,
 * the current's flux x = (L_d i_d, L_q i_q) as state:
 *
 *     dx/dt = A x + u_dq(t) - (0, omega psi_f)     A = [-R/L_d  omega; -omega  -R/L_q]
 *     u_dq(t) = e^(-j omega t) u_dq(0)             constant in the stationary frame
 *
 *     x(T) = decay x(0) + drive u_dq(0) + push f,  f = (0, -omega psi_f)
 *     decay = e^(A T)   drive = int_0^T e^(A (T-s)) e^(-j omega s) ds   push = int_0^T e^(A s) ds
 *
 * Nothing divides by the speed or the resistance: standstill, reverse and R = 0 are ordinary points. In flux
 * the matrix does not grow with the saliency, so that the series of the exponential subtracts as little as it
 * can: error below 2e-15 of a matrix's largest entry at |omega T| = 2.1 (three cycles a revolution), below
 * 1e-13 (of 1 and of T) at 2 pi, for R T/L up to 2 and L_q/L_d up to 8.
 */
#ifndef SIM_HOST_MODEL_EXACT_MAP_H
#define SIM_HOST_MODEL_EXACT_MAP_H

typedef struct exact_map {
    double decay[2][2]; /* 1 */
    double drive[2][2]; /* s */
    double push[2][2];  /* s */
} exact_map;

/* To the flux at the end of the span, and to its mean over the span. mean: NULL if it is not wanted. Needs
 * L_d_H, L_q_H > 0 and R_ohm >= 0. */
void exact_maps(double R_ohm, double L_d_H, double L_q_H, double span_s, double omega_rad_s, exact_map *end,
                exact_map *mean);

#endif

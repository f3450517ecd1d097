/*
 * Flux linkage of a current in the rotor frame and back, of an averaged drive that saturates. Without the
 * magnet's flux, which does not depend on current.
 *
 * Two laws, each the gradient of an energy W of the currents d and q (so that the cross inductances are alike):
 *     saturation      L / (1 + (i/I_sat)^2) in both axes, i^2 = 2 (L_d d^2 + L_q q^2)/(L_d + L_q)
 *     saturation_dq   the same, of L_d0 and L_q0 and without I_sat constant, and the terms
 *                     w_ddd d^3 + w_dqq d q^2 + w_dddd d^4 + w_ddqq d^2 q^2 + w_qqqq q^4 of W
 *                     and E_k (rho_k - its expansion to second order about no current) for each of two parts of the iron,
 *                     rho_k = sqrt(1 + ((d - I_ck)/I_dk)^2 + (q/I_qk)^2)
 * The terms alone turn back soon beyond the currents that they were fitted to; they are small compared with the saturation.
 * A part's inductances fall with the current from every side: E/I_d^2 and E/I_q^2 at its centre I_c, none far away. So L_d_H and L_q_H
 * stay the inductances at no current, and with parts alone W is convex at every current if it is far away.
 */
#ifndef SIM_HOST_MODEL_FLUX_MAP_H
#define SIM_HOST_MODEL_FLUX_MAP_H

#include "averaged_drive.h"

bool flux_map_has_terms(const averaged_drive *drive);

/* Whether the flux is not in proportion to the current: a fall with it, or terms. */
bool flux_map_bends(const averaged_drive *drive);

/* dflux/di: dd, dq (= qd), qq. */
typedef struct flux_map_slope {
    double dd, dq, qq;
} flux_map_slope;

/* The inductances of a part at no current. Far away it has none. */
flux_map_slope flux_map_part_slope(const iron_part *p);

/* A map at one current. */
typedef struct flux_map_point {
    vec_dq flux;
    flux_map_slope slope;
} flux_map_point;

flux_map_point flux_map_at(const averaged_drive *drive, vec_dq i);

/* The flux alone. */
vec_dq flux_map_flux(const averaged_drive *drive, vec_dq i);

/*
 * The current that carries a flux. Without terms in closed form; at the largest flux it is twice the unsaturated current, and so it is
 * beyond. With terms by Newton's method from a guess, to about 1e-10 of it. Where the incremental inductance is not that of a machine
 * (the flux falls as the current rises), the step is that without saturation. A flux that lies beyond all that a map can carry has the
 * current of the first step, by the inductance at the guess.
 */
vec_dq flux_map_current(const averaged_drive *drive, vec_dq flux, vec_dq guess);

/* A guess at that: Newton's first step from a current whose point on the map is known. */
vec_dq flux_map_guess(const averaged_drive *drive, vec_dq flux, vec_dq i, const flux_map_point *at);

/* Whether a machine can have it: both of its principal values at least `share` of the lesser unsaturated one. */
bool flux_map_is_physical(const averaged_drive *drive, vec_dq i, double share);

/*
 * Whether W with its parts is convex at any current: far away, where each part's inductances have fallen to nothing, both inductances
 * at least `share` of the lesser one at no current. Without terms (w_ddd ... I_sat) that decides.
 */
bool flux_map_is_convex(const averaged_drive *drive, double share);

#endif

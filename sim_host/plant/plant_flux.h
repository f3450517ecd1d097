/*
 * Flux linkage of the iron in the rotor frame and its rate by the current: constant inductances, saturation of
 * both axes alike, or a flux map. Without the magnet's flux, which does not depend on current.
 *
 * Each is the gradient of one function of the currents, the co-energy, so that the inductances between the axes
 * are alike and no energy comes from nothing.
 */
#ifndef SIM_HOST_PLANT_PLANT_FLUX_H
#define SIM_HOST_PLANT_PLANT_FLUX_H

#include "../base/vector.h"
#include "plant_config.h"

#include <stdbool.h>

typedef struct plant_flux {
    vec_dq psi_Wb;
    double L_dd_H, L_dq_H, L_qq_H; /* dpsi/di */
} plant_flux;

/*
 * Saturation of both axes: flux linkage over current, relative to its value at zero current, and (its slope)/i,
 * at a current whose size is i_A. A salient machine's is measured by its energy,
 * i^2 = 2 (L_d i_d^2 + L_q i_q^2)/(L_d + L_q); without it the two cross inductances would differ.
 * The law 1/(1 + (i/I_sat)^2) has a flux that turns back at I_sat, which no iron does: from 0.8 I_sat on,
 * where the differential inductance has fallen to 13 % of L_0, the flux goes on in a straight line.
 */
void machine_saturation(const plant_machine *m, double i_A, double *factor, double *slope_over_i);

bool plant_flux_has_map(const plant_machine *m);

/*
 * Finds how far the map is one that iron can have, both principal inductances at least a tenth of the lesser
 * one at no current: map_reach_A, at most four times I_scale_A. Returns the least of all directions; without a map that limit.
 */
double plant_flux_find_reach(plant_machine *m, double I_scale_A);

/*
 * A map's terms add to the saturation of both axes, which then follows the plain model at any current. Beyond the planes
 * that a map's reach spans, the flux rises steeply: a polynomial would turn back there, and iron
 * does not. map_reach_A must be set.
 */
void plant_flux_at(const plant_machine *m, vec_dq i_A, plant_flux *f);

#endif

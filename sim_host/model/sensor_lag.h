/*
 * Current sensors with a first-order filter of time constant tau, or that are sampled
 * late against the carrier (tau < 0: by -tau).
 *
 * Around the valley no leg is high: the current falls against the back-EMF alone, whatever the cycle's mean voltage
 * is, and tau times that slope is what the reading is off by. In the rotor frame, with W the volt-seconds of the legs
 * that the filter still sees (or the late sample already), psi the whole flux:
 *
 *     seen = i - L^-1 (W - t (R i + j omega psi)) - t j omega i
 *
 * t = tau (1 - j omega tau), the rotor's turn meanwhile included to first order; (1 - j omega tau/2) of a late sample.
 * While no leg is high (W = 0) the flux stands still, and but for R this is the current of that flux with the rotor
 * where it was tau ago: an angle read late by tau. It is the edges that a filter still sees that tell the two apart.
 * The map is linear in the current, and so a part of the map from true to recorded currents.
 *
 * An iron's branch (iron_branch.h) carries a part of the current that is behind no inductance: the voltage through a pole of its own,
 * tau_fe, and what a filter shows of that is the voltage through two,
 *
 *     seen = (tau_fe i(tau_fe) - tau i(tau)) / (tau_fe - tau)
 *
 * i(x) being the branch's current if its time constant were x. In a late sample it has faded meanwhile.
 */
#ifndef SIM_HOST_MODEL_SENSOR_LAG_H
#define SIM_HOST_MODEL_SENSOR_LAG_H

#include "iron_branch.h"

/* The iron's current from row to row, its own and by the filter's time constant. All zero at the start of a pass. */
typedef struct lag_memory {
    iron_memory own, by_filter;
} lag_memory;

/*
 * The map of sensors at a row that see the current so late. T_s: the cycle. `i`: the true current there, from a run of the drive. The
 * recorded one would do but for its noise: where iron saturates, the reading that the map predicts would follow that noise. The rotor is that
 * at the row; `last_turn`: that of the row before it, or NULL, where it is found.
 */
sensor_map sensor_lag_map(const averaged_drive *drive, const cycle_row *row, double T_s,
                          const sensor_map *map, vec_rotor rotor, const cycle_turn *last_turn, vec_ab i,
                          lag_memory *memory);

#endif

/*
 * What dead time and its compensation take of a leg's voltage, each edge with the current that it finds.
 *
 * A compensation moves a leg's two edges by the sign of its current at the cycle's start. An edge then loses its dead time by the
 * current that flows there: the cycle's mean slope, the ripple that the duties tell, and what the edges before it, moved
 * or late, have already changed. A current that reaches zero within the dead time stays there and loses a share: sat of
 * the current half a dead time on with the leg half way between the rails, over the knee.
 */
#ifndef SIM_HOST_MODEL_FOUND_EDGES_H
#define SIM_HOST_MODEL_FOUND_EDGES_H

#include "averaged_drive.h"

/* The phases' currents over a row's cycle as if nothing were lost. */
typedef struct found_currents {
    double first[3], last[3];
    double apart[3]; /* when leg x rises, above the mean of first and last; as much below it when x falls */
    double per_flux[3]; /* 1/L in the stationary frame: aa, ab, bb */
    double T_s;
} found_currents;

/* The current added by a flux in addition to the machine's own. */
static inline vec_ab found_current(const found_currents *i, vec_ab flux)
{
    const double *k = i->per_flux;
    return (vec_ab){k[0] * flux.alpha + k[1] * flux.beta, k[1] * flux.alpha + k[2] * flux.beta};
}

/* Finds per_flux and apart of first and last, the rotor at r: by as much of the ripple as edge_ripple says. */
void found_currents_apart(const averaged_drive *d, const cycle_row *row, vec_rotor r, found_currents *i);

/* The mean voltage that each leg loses over the cycle under EDGE_FOUND: v_dead against a current far from zero. */
void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_currents *i, double lost[3]);

/*
 * What a dead time takes of each leg at its rise and at its fall, as the cycle's mean voltages: all at the rise if the current
 * flows out, all at the fall (which then is later) if it flows in. By the current that each edge finds, between that at the start and
 * where it turns to. A compensation has moved both edges, by the sign at the start.
 */
void found_edges_each(const averaged_drive *d, const cycle_row *row, vec_ab i, double rise_V[3],
                      double fall_V[3]);

#endif

/*
 * What dead time and its compensation take of a leg's voltage, each edge with the current that it finds.
 *
 * A compensation moves a leg's two edges by the sign of its current at the cycle's start. An edge then loses its dead time by the
 * current that flows there: the way from the cycle's first current to its last, the ripple that the duties tell, and what the edges
 * before it, moved or late, have already changed. That way is no chord: the flux goes straight, and the magnet turns below it. A
 * current that reaches zero within the dead time stays there and loses a share: sat of the current half a dead time on with the leg
 * half way between the rails, over the knee.
 *
 * Devices that conduct take their share, `conduction`, all through the cycle by the sign that the current has: it goes straight from edge
 * to edge. One that reaches zero stays there while the drop of the devices can hold it.
 */
#ifndef SIM_HOST_MODEL_FOUND_EDGES_H
#define SIM_HOST_MODEL_FOUND_EDGES_H

#include "averaged_drive.h"

/* A row's turn, complete; the rotor at `start` when it begins. */
cycle_turn found_turn_of(const averaged_drive *d, const cycle_row *row, vec_rotor start);

/* The phases' currents over a row's cycle as if nothing were lost. */
typedef struct found_way {
    const cycle_turn *turn;
    double first[3], last[3];
    double seen[3]; /* by which a compensation decides */
    double bow[3];  /* half-way above the mean of first and last */
} found_way;

/* From one current to another. */
found_way found_way_of(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn, vec_ab first,
                       vec_ab last, vec_ab seen);

/*
 * The voltage that each leg loses over a cycle of T_s, as one that acts evenly: v_dead against a current far from zero. What is lost early
 * has decayed by the cycle's end. Of several carrier periods in a cycle each finds its own part of the way.
 */
void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_way *way, double T_s,
                      double lost[3]);

typedef struct edge_losses {
    double rise_V[3], fall_V[3];
} edge_losses;

/*
 * What a dead time takes of each leg at its rise and at its fall, as the cycle's mean voltages: all at the rise if the current
 * flows out, all at the fall (which then is later) if it flows in. By the current that each edge finds, between that at the start and
 * where it turns to. A compensation has moved both edges, by the sign at the start. `turn`: the row's, or NULL, where it is found.
 */
edge_losses found_edges_each(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn, vec_ab i);

#endif

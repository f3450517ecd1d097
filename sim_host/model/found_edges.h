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

/* The current of the iron-loss branch at each leg's edges: it follows each pulse, and does not turn with the rotor. */
typedef struct edge_iron {
    vec_ab start_A;              /* at the cycle's start, which the way below has at both ends */
    vec_ab rise_A[3], fall_A[3]; /* above that */
    double most_A;               /* no phase has more at an edge */
    double left[3],
        fade; /* e to minus the time until each leg's rise, and the cycle's, over the branch's time constant */
    double per_H; /* what a flux that an edge changes adds to it at once */
} edge_iron;

/* The phases' currents over a row's cycle as if nothing were lost. */
typedef struct found_way {
    const cycle_turn *turn;
    const edge_iron *iron; /* NULL: none */
    double first[3], last[3];
    double seen[3]; /* by which a compensation decides */
    double bow[3];  /* half-way above the mean of first and last */
} found_way;

/* From one current to another. */
found_way found_way_of(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn,
                       const edge_iron *iron, vec_ab first, vec_ab last, vec_ab seen);

/* What is lost at each leg's rise and at its fall, as the cycle's mean voltages. Half of what devices take is at either. */
typedef struct edge_losses {
    double rise_V[3], fall_V[3];
} edge_losses;

/*
 * The voltage that each leg loses over a cycle of T_s, as one that acts evenly: v_dead against a current far from zero. What is lost early
 * has decayed by the cycle's end. Of several carrier periods in a cycle each finds its own part of the way. *each: as lost, undecayed.
 */
void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_way *way, double T_s,
                      double lost[3], edge_losses *each);

/*
 * The same of a cycle that has passed, from its first current to its last. `turn`: the row's, or NULL, where it is found. `iron`: NULL or
 * the branch's, whose current is the same in both.
 */
edge_losses found_edges_each(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn,
                             const edge_iron *iron, vec_ab first, vec_ab last);

#endif

/*
 * The iron-loss branch: the current in addition to the flux-producing one, R_fe i_fe + tau R_fe di_fe/dt = dpsi/dt = u - drop, the drop
 * being that over the phases' resistances, of the whole current.
 *
 * At a sampling instant it is what the pulses of the cycles before have left, each less by e^{-t/tau} of the time since.
 * A branch that is fast against the cycle sees the pulses apart (at the carrier's valley none is on), so that cycles count by
 * their edges, as a dead time moves them. The drop goes from one sampled current's to the next one's.
 *
 * The current of turns that are shorted, as it shows at the terminals, is the same along their phase's axis alone.
 */
#ifndef SIM_HOST_MODEL_IRON_BRANCH_H
#define SIM_HOST_MODEL_IRON_BRANCH_H

#include "found_edges.h"
#include "sensor_chain.h"

/*
 * What the cycles before a row have left, carried from row to row. All zero at the start of a pass, where it is summed from
 * the rows before (cycle_row's history); a pass that continues at another row than this or the next sums again.
 */
struct iron_memory {
    const cycle_row *row; /* at whose start it is valid; NULL: none yet */
    double per_tau, fade; /* the cycle over the branch's time constant, and e to minus that */
    bool is_iron;
    double of_start,
        of_end; /* what a cycle leaves of the drop that it starts with, and of the one that it ends with */
    sensor_course sensors;
    vec_ab left;        /* times R_fe; of the drop all but the row's own current's */
    edge_losses before; /* of the cycle before, where the row has a history */
};

/*
 * The branch's current at the start of a row's cycle, if its time constant were tau_s. `before`: the losses of the cycle before, or NULL,
 * where they are found. The memory is left at the row.
 */
vec_ab iron_branch_at(const averaged_drive *d, double tau_s, const cycle_row *row, vec_ab i,
                      iron_memory *memory, const edge_losses *before);

/* Whether there is one: the iron's, or a loop of shorted turns. */
static inline bool iron_branch_present(const averaged_drive *d)
{
    return d->fe_S != 0.0 || d->short_S[0] != 0.0 || d->short_S[1] != 0.0 || d->short_S[2] != 0.0;
}

/* The current of a voltage. */
vec_ab iron_branch_conducts(const averaged_drive *d, vec_ab V);

/* What is left at a cycle's end of a short pulse at each leg's rise, and of one at its fall: it is on from rise T to (1 - rise) T. */
typedef struct edges_left {
    double rise[3], fall[3];
} edges_left;

/* What a row's cycle finds: the same at its start, over it and at its end, and the dear part of these. */
typedef struct iron_branch {
    const cycle_row *row;
    double per_tau, of_end; /* as in iron_memory */
    vec_ab first, last;     /* i_fe R_fe at either end, but for the drop that the end's own current causes */
    vec_ab mean_V;          /* over the cycle, ahead of the phases' drop */
    edge_iron edges;        /* of a drive that loses at its edges; else per_H is zero */
    edges_left left;        /* of the command that acts */
} iron_branch;

/*
 * For the phase current i at the start of the row's cycle, which it is a part of, as if the edges lost nothing. The memory is left at the
 * row after.
 */
iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row, vec_ab i, iron_memory *memory);

/* Takes in what the edges of the row's cycle lose, at its end and in the memory, if there is one. Returns by how much the mean is less. */
vec_ab iron_branch_loses(const averaged_drive *d, iron_branch *b, iron_memory *memory,
                         const edge_losses *lost);

/* At the start of the row's cycle. */
vec_ab iron_branch_begin(const averaged_drive *d, const iron_branch *b);

/* Its mean over the cycle, for a phase current that changes from one value to the other. */
vec_ab iron_branch_mean(const averaged_drive *d, const iron_branch *b, vec_ab i_start, vec_ab i_end);

/* At the end, for the flux-producing current i: the phase current is the sum. */
vec_ab iron_branch_end(const averaged_drive *d, const iron_branch *b, vec_ab i);

#endif

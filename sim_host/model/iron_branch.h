/*
 * The iron's branch: the current beside the one that makes flux, R_fe i_fe + tau R_fe di_fe/dt = dpsi/dt = u - R i.
 *
 * At a sampling instant it is what the pulses of the cycles before have left, each less by e^{-t/tau} of the time since.
 * A branch that is fast against the cycle sees the pulses apart (at the carrier's valley none is on), so that the last
 * cycles count by their edges; older ones by their means.
 */
#ifndef SIM_HOST_MODEL_IRON_BRANCH_H
#define SIM_HOST_MODEL_IRON_BRANCH_H

#include "averaged_drive.h"

/* What a row's cycle finds: the same at its start and at its end, and the dear part of both. */
typedef struct iron_branch {
    const cycle_row *now; /* whose command acts */
    double per_tau, fade; /* the cycle over the branch's time constant, and e to minus that */
    vec_ab old;           /* what the cycles before have left, times R_fe, without the drop over R */
} iron_branch;

/* Reads the rows before (cycle_row's history). */
iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row);

/* At the start of the row's cycle, and at its end, beside the phase current i, which it is a part of. */
vec_ab iron_branch_begin(const averaged_drive *d, const iron_branch *b, vec_ab i);
vec_ab iron_branch_end(const averaged_drive *d, const iron_branch *b, vec_ab i);

#endif

/*
 * Pieces that a next recording could be made of, run in the averaged model of what was found: what a cycle of each
 * would tell, as the information that the diagnosis would have of it.
 *
 * Of each piece a few windows are run, evenly spread over its course, with a current that follows its reference as
 * behind a current control: what a window tells stands for its share of the piece, however long that is. Limits are
 * those that the recording itself kept: its largest current and speed, its DC link.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_TRIAL_H
#define SIM_HOST_DIAGNOSE_NEXT_TRIAL_H

#include "diagnose/choose/session.h"
#include "plan/plan_pieces.h"

typedef struct trial {
    plan_limits limits;
    size_t pieces;
    plan_piece piece[PLAN_PIECES];
    double (*h)[COLUMN_COUNT][COLUMN_COUNT]; /* of one cycle of each, in the columns' places */
} trial;

/* The limits that the recording kept. A rotor that stood may turn with a quarter of the file's largest speed. */
plan_limits trial_limits(const session *w);

/*
 * Runs the pieces that `m`, the motor as it was found, allows, and looks at these columns of them at the session's
 * state. False if there is no memory, or the model found runs away in them; the caller frees.
 */
bool trial_run(trial *t, const session *w, const motor *m, const int *column, size_t columns);

void trial_free(trial *t);

#endif

/*
 * Test segments for the next recording, simulated in the averaged extended model: the information matrix of one cycle of each. A few
 * windows of each segment are simulated, evenly spread, with a current that follows its reference as in closed loop. A window represents
 * its share of the segment. The limits are those of the recording: its largest current and speed, its DC link.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_TRIAL_H
#define SIM_HOST_DIAGNOSE_NEXT_TRIAL_H

#include "data/plan_pieces.h"
#include "diagnose/session.h"

typedef struct trial {
    plan_limits limits;
    size_t pieces;
    plan_piece piece[PLAN_PIECES];
    double (*h)[COLUMN_COUNT][COLUMN_COUNT]; /* of one cycle of each, in the columns' places */
} trial;

/*
 * Runs the pieces that `m`, the motor as it was found, allows, and looks at these columns of them at the session's
 * state. False if there is no memory, or the model found runs away in them; the caller frees.
 */
bool trial_run(trial *t, const session *w, const motor *m, const int *column, size_t columns);

void trial_free(trial *t);

#endif

/*
 * The rows of trial.h: windows of test segments, as a recording of the averaged model.
 */
#ifndef SIM_HOST_DIAGNOSE_NEXT_TRIAL_ROWS_H
#define SIM_HOST_DIAGNOSE_NEXT_TRIAL_ROWS_H

#include "data/plan_pieces.h"
#include "diagnose/session.h"

enum {
    TRIAL_WINDOW = 64,      /* cycles: both squares change within them */
    TRIAL_WINDOWS_MOST = 4, /* of a piece */
    TRIAL_WINDOWS = TRIAL_WINDOWS_MOST * PLAN_PIECES
};

typedef struct trial_rows {
    recording recording;         /* a run for each window */
    size_t piece[TRIAL_WINDOWS]; /* whose it is */
} trial_rows;

/* False if there is no memory, or the model runs away. The caller frees the recording. */
bool trial_rows_make(trial_rows *out, const session *w, const plan_piece *piece, size_t pieces,
                     double u_dc_V);

#endif

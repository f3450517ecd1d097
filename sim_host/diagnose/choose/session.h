/*
 * What one diagnosis works on, from its rows to what was found.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_SESSION_H
#define SIM_HOST_DIAGNOSE_CHOOSE_SESSION_H

#include "certainty.h"

typedef struct session {
    diagnose_rows rows;
    coordinate_frame frame;
    fit_data fitted;
    fit_state state;
    fit_state nominal;
    certainty certainty;
    hypothesis_set possible;
    hypothesis_set allowed; /* of these what was not dropped */
    bool more_left;         /* than the best causes explained: none of them is named */
} session;

static inline averaged_drive session_drive(const session *w, const double z[P_COUNT])
{
    return coordinates_drive(&w->frame, z, w->state.edge);
}

/* Adds a hypothesis' fitted values to a partial model. */
static inline void session_adopt(const session *w, hypothesis_id h, double z[P_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[h];
    hypothesis_copy(h, w->state.z, z);
    for (size_t k = 0; k < hypo->shapes; k++) {
        z[hypo->shape[k]] = w->state.z[hypo->shape[k]];
    }
}

#endif

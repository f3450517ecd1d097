/*
 * What one diagnosis works on, from its rows to what was found.
 */
#ifndef SIM_HOST_DIAGNOSE_SESSION_H
#define SIM_HOST_DIAGNOSE_SESSION_H

#include "base/error.h"
#include "identify/whole_fit.h"
#include "weigh/certainty.h"
#include "weigh/evidence.h"
#include "weigh/probability.h"
#include "weigh/teller.h"

/* How a state was found: by the search (choose/causes.h), or a fit of the whole drive (choose/whole_drive.h, choose/likely_drive.h). */
typedef enum session_way { SESSION_SEARCH, SESSION_WHOLE_DRIVE, SESSION_LIKELY_DRIVE } session_way;

typedef struct session {
    const motor *file;
    hypothesis_set skip; /* not to be looked for */
    diagnose_teller teller;
    diagnose_rows rows;
    coordinate_frame frame;
    fit_data fitted;
    fit_state state;
    fit_state nominal;
    certainty certainty;
    hypothesis_set possible;
    hypothesis_set allowed;          /* of these what was not dropped */
    hypothesis_set minor;            /* members of the state's set that are no causes: small, or undecided */
    hypothesis_set undecided;        /* of these, those that the recording neither shows nor rules out */
    drive_scale scale[DRIVE_SCALES]; /* of a set of the whole drive; shares of 0 otherwise */
    evidence_view view;              /* of the state that was last searched from or is reported */
    rival_fits rivals;               /* of that state */
    fit_state best;                  /* the state, or what was fitted before all of it was given up */
    double borne_out, corrections_borne_out; /* probability of the members, of these and the corrections */
    session_way way;                         /* to the state */
    bool more_left;                          /* than the best causes explained: none of them is named */
    bool no_memory;                          /* memory ran out in a measure (rows.no_memory) */
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
    if (hypo->cause == CAUSE_CURRENT_OFFSET) {
        /* What the offsets have in common shows from sector to sector. */
        z[P_OFFSET_ZERO] = w->state.z[P_OFFSET_ZERO];
    }
}

/* A member is undecided if another factor on the drive leaves it small with this probability. */
#define SESSION_SCALE_DOUBTED 0.05

/* The probability that by another factor on the drive a member is not beyond its reporting threshold; 0 of one that no factor scales. */
double session_scale_doubt(const session *w, hypothesis_id h);

/* Hypotheses that compete with the members: all possible ones. Those in whose place one factor on the drive puts a member have shares of
 * w->scale already. */
hypothesis_set session_rivals(const session *w);

/* Prints to the trace, if there is one. */
void session_trace(const session *w, const char *format, ...) ERROR_PRINTF(2, 3);

/* Looks at all sets from the state into w->view, which stays valid until the rows or the state change. False: out of memory. */
bool session_look(session *w);

/* Errors are in percent of the current, on held-out rows without glitches. The noise floor at a state. */
double session_floor(const session *w, const fit_state *s);

/*
 * What a size may be wrong by because the averaged model is not exact: shares of the reporting threshold, and of the effect. A fit of the
 * whole drive holds what is small as well, so that a dead time's model error has nothing else to affect.
 */
typedef struct session_strays {
    double of_least, of_effect;
} session_strays;
session_strays session_model_strays(const session *w, cause_id cause);

/* Whether a member of w->state's set is certainly larger than its reporting threshold. */
bool session_is_large(const session *w, hypothesis_id h);

/* Of the model that holds the named members of a set at the fitted values; of the motor file for an empty set. */
double session_named_error(const session *w, hypothesis_set set);

/* Whether the set of w->state holds an effect without a name. */
bool session_holds_unnamed(const session *w);

/* Whether the error of w->state exceeds so many noise floors. */
bool session_leaves(const session *w, double floors);

/*
 * The probability that the named members of w->state are the effects that act (borne_out.h), against the nominal model on some rows: the
 * corrected ones, or those before the corrections, to weigh these as well. Of the one-cycle
 * error and the open-loop error the one counts that is explained better: one cycle hardly shows a current's offset or gain, and a
 * dead time that is compensated makes the open-loop simulation depend on the noise of a current near zero. An open-loop error that rises
 * counts, unless the dead time is over-compensated. What is left by the angle (discrepancy.h) counts if it is more. A motor file with a
 * dead time of its own counts as if nothing were left.
 */
double session_borne_out(session *w, const diagnose_rows *from);

/* Whether a state whose error is so many percent explains most of the nominal model's error above the noise floor. */
bool session_explains_most(const session *w, const fit_state *s, double percent);

#endif

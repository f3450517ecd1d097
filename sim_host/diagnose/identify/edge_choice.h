/*
 * Chooses the edge model of a dead time for this recording, by likelihood. The edge model (edge_law) describes how the voltage loss
 * depends on a current near zero: a dead time alone has charged or clipped edges, one with a compensation begins at clipped ones.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H

#include "fit_data.h"

/*
 * If no dead time is fitted, its derivative by the knee current is zero. Then tries knee currents and edge models and leaves in *s
 * those with which a dead time would reduce the error most. A dead time that is fitted or in the motor file keeps its model. False:
 * out of memory.
 */
bool edge_choose(fit_data *d, fit_state *s);

/* Prepares the state for a compensation if its set holds one, and leaves none if it does not. */
void edge_of_set(const fit_data *d, fit_state *s);

/*
 * The last comparison of the two edge models: the difference of their objectives, and the smaller objective. Zeros: none so
 * far.
 */
typedef struct edge_contest {
    double apart, objective;
} edge_contest;

/*
 * Fits the other edge model to the state's dead time and keeps the better one. Does so again only if the objective has
 * changed by a quarter of the last difference: a smaller change cannot exchange the models. False: out of memory.
 */
bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last);

#endif

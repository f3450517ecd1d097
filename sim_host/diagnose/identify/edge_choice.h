/*
 * Which law a dead time follows near zero current, in this recording: charged or clipped edges, found by
 * likelihood.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H

#include "fit_data.h"

/*
 * While no dead time is fitted its derivative by the knee is nothing; the knee and the law under which it
 * would pay most are then found by trial and left in *s. False: out of memory.
 */
bool edge_choose(fit_data *d, fit_state *s);

/* The last contest of the laws: how far apart they were, and where the better one lay; noughts: there was none. */
typedef struct edge_contest {
    double apart, objective;
} edge_contest;

/*
 * The other laws for a dead time that stands in the model, each fitted; the best stays. Again only where what has joined
 * since the last contest takes off a quarter of what set the laws apart: less turns nothing round.
 */
bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last);

#endif

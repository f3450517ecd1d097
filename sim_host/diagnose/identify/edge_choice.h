/*
 * Which law a dead time follows near zero current, in this recording, found by likelihood: charged or clipped edges of a plain one;
 * with a compensation each edge goes by the current that it finds.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_EDGE_CHOICE_H

#include "fit_data.h"

/*
 * While no dead time is fitted its derivative by a knee is nothing; the knees and the law under which it would pay most are then
 * found by trial and left in *s. One that is fitted already stays. False: out of memory.
 */
bool edge_choose(fit_data *d, fit_state *s);

/* The law that the state's set asks for: that of a compensation for its own hypothesis, a plain one for any other. */
void edge_of_set(const fit_data *d, fit_state *s);

/* The last contest of the laws: how far apart they were, and where the better one lay; noughts: there was none. */
typedef struct edge_contest {
    double apart, objective;
} edge_contest;

/*
 * The other law for a plain dead time that is in the model, fitted; the better one stays. Again only where what has joined
 * since the last contest reduces the objective by a quarter of the laws' distance: less changes no order.
 */
bool edge_revise(fit_data *d, fit_state *s, int refine_steps, edge_contest *last);

#endif

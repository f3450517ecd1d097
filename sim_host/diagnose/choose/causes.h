/*
 * The causes of one recording: found, and weighed until all that stay deserve their name.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_CAUSES_H
#define SIM_HOST_DIAGNOSE_CHOOSE_CAUSES_H

#include "diagnose/session.h"

/*
 * Searches from w->nominal and drops what is not certain, or too small a part, until all that stays is. What is dropped may have kept
 * something better out, so search and prune take turns until a search finds nothing new, or so much was tried that none begins any more
 * (fit_has_spent). Leaves the fit in w->state, and w->allowed without what was dropped. False: out of memory.
 */
bool causes_find(session *w);

/*
 * Takes out the members that raise the held-out error: what is named must make the model better on rows that were not fitted. False:
 * out of memory.
 */
bool causes_reject_harmful(session *w);

/* What was found is left as it is if it explains as much as it leaves (borne_out.h);
 * if not, a search begins among the effects without a name. False: out of memory. */
bool causes_bear_out(session *w);

/*
 * Where the inductance differs from the motor file's at no current and, by the same sign, at the rated one, its fall is not what
 * makes the file wrong: the inductance is a cause of its own. The same model, reported as two causes. False: out of memory.
 */
bool causes_split_saturation(session *w);

#endif

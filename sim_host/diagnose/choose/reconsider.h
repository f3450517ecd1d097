/*
 * A second beginning, where the first left something.
 *
 * While the state is a bad fit, a set's parabola tells little of where its fit ends. One that cannot keep its names, or an effect
 * without a name, then takes the place of the right one by a hair, and from where that one's fit ended nothing leads back.
 */
#ifndef SIM_HOST_DIAGNOSE_CHOOSE_RECONSIDER_H
#define SIM_HOST_DIAGNOSE_CHOOSE_RECONSIDER_H

#include "session.h"
#include "teller.h"

/* Whether the state's one-cycle error is more than the verdict allows. */
bool session_leaves_something(const session *w);

/* Whether its set holds an effect without a name. */
bool session_holds_unnamed(const session *w);

/*
 * Where what was found holds an effect without a name, or leaves more than the verdict allows: searches once more from the motor
 * file, without what was dropped and without that effect. The better of the two states stands, and what it names is weighed as
 * the first was. Where nothing was found, the first search has ended that way already; after as much as fit_has_spent says
 * none begins. False: out of memory.
 */
bool reconsider(session *w, const diagnose_teller *teller);

#endif

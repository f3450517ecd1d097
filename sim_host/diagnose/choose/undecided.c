/* Which fitted members are no causes, as the recording does not decide (undecided.h). */
#include "undecided.h"

#include "diagnose/weigh/probability.h"

#include <math.h>

/* That of the catalogue must be at least this for any cause. */
static const double BORNE_OUT = 0.95;

/* The named members, but for minor ones, whose probability among all sets near the state is below the limit. False: out of memory. */
static bool find_below(session *w, double limit, hypothesis_set *below)
{
    standing of[H_COUNT];
    if (!session_look(w) || !probability_of(&w->view, &w->state, session_rivals(w), w->certainty.inflation,
                                            &w->fitted, &w->rivals, of)) {
        return false;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set & ~w->minor), h) && of[h].probability < limit) {
            *below |= HYPOTHESIS_BIT(h);
            session_trace(w, "  probability %.2f: %s\n", of[h].probability, hypothesis_table[h].words);
        }
    }
    return true;
}

bool undecided_accuse_none(session *w, double limit)
{
    const hypothesis_set causes = hypotheses_named(w->state.set & ~w->minor);
    hypothesis_set below = 0;
    if (causes != 0 && !find_below(w, limit, &below)) {
        return false;
    }
    below = w->borne_out < BORNE_OUT ? causes : below;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(below, h)) {
            session_trace(w, "  fitted, but not certain enough for a name: %s\n", hypothesis_table[h].words);
        }
    }
    w->minor |= below;
    w->undecided |= below;
    return true;
}

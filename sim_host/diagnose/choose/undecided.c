/* Which fitted members are no causes, as the recording does not decide (undecided.h). */
#include "undecided.h"

#include "probability.h"

#include <stdlib.h>

/* A cause is named if its probability among all sets near the chosen one, and that of the catalogue, are at least this. */
static const double DECIDED = 0.95;
/* That of a member of a fit of likely effects, which are not compared with all others. */
static const double LIKELY = 0.5;

/* The named members, but for minor ones, whose probability among all sets near the state is below the limit. False: out of memory. */
static bool find_below(session *w, double limit, hypothesis_set *below, FILE *trace)
{
    standing of[H_COUNT];
    evidence_view *view = calloc(1, sizeof *view);
    bool ok = view && evidence_look(&w->fitted, &w->state, w->possible, view);
    if (ok) {
        view->explained = fmax(w->nominal.objective - w->state.objective, 0.0);
        ok = probability_of(view, &w->state, w->possible, w->certainty.inflation, of);
    }
    for (hypothesis_id h = 0; ok && h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set & ~w->minor), h) && of[h].probability < limit) {
            *below |= HYPOTHESIS_BIT(h);
            if (trace) {
                fprintf(trace, "  probability %.2f: %s\n", of[h].probability, hypothesis_table[h].words);
            }
        }
    }
    free(view);
    return ok;
}

bool undecided_accuse_none(session *w, bool likely, FILE *trace)
{
    const hypothesis_set causes = hypotheses_named(w->state.set & ~w->minor);
    w->undecided = 0;
    if (causes != 0 && !find_below(w, likely ? LIKELY : DECIDED, &w->undecided, trace)) {
        return false;
    }
    w->undecided = w->borne_out < DECIDED ? causes : w->undecided;
    for (hypothesis_id h = 0; trace && h < H_COUNT; h++) {
        if (hypothesis_in(w->undecided, h)) {
            fprintf(trace, "  fitted, but not certain enough for a name: %s\n", hypothesis_table[h].words);
        }
    }
    w->minor |= w->undecided;
    return true;
}

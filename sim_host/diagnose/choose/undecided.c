/* Takes out causes that the recording cannot separate from others (undecided.h). */
#include "undecided.h"

#include "causes.h"
#include "diagnose/identify/fit.h"
#include "probability.h"

#include <stdlib.h>

/* A cause is named if its probability, among all sets near the chosen one, is at least this. */
static const double DECIDED = 0.95;

enum { STEPS = 12 };

/* The named members whose probability is below DECIDED, at the state. False: out of memory. */
static bool find_undecided(session *w, hypothesis_set *undecided)
{
    standing of[H_COUNT];
    evidence_view *view = calloc(1, sizeof *view);
    const bool ok = view && evidence_look(&w->fitted, &w->state, w->possible, view) &&
                    probability_of(view, &w->state, w->possible, w->certainty.inflation, of);
    *undecided = 0;
    for (hypothesis_id h = 0; ok && h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set) & ~w->minor, h) && of[h].probability < DECIDED) {
            *undecided |= HYPOTHESIS_BIT(h);
        }
    }
    free(view);
    return ok;
}

static void take_out(session *w, hypothesis_set set, FILE *trace)
{
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h)) {
            if (trace) {
                fprintf(trace, "  one of several explanations: %s\n", hypothesis_table[h].words);
            }
            causes_take_out(&w->state, h, 0, w->frame.of_least);
        }
    }
    w->undecided |= set;
}

bool undecided_take_out(session *w, const diagnose_teller *teller)
{
    hypothesis_set undecided;
    w->undecided = 0;
    if (hypotheses_named(w->state.set & ~w->minor) == 0) {
        return true;
    }
    w->open = w->state;
    if (!find_undecided(w, &undecided)) {
        return false;
    }
    if (undecided == 0) {
        return true;
    }
    take_out(w, undecided, teller->trace);
    if (!fit_refine(&w->fitted, &w->state, STEPS)) {
        return false;
    }
    /* The others may fit only together with what was taken out. */
    if (session_named_error(w, w->state.set) >= session_named_error(w, 0)) {
        take_out(w, hypotheses_named(w->state.set) & ~w->minor, teller->trace);
        w->state = w->nominal;
        w->minor = 0;
    }
    return certainty_of(&w->fitted, &w->state, &w->certainty);
}

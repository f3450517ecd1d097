/* Takes out causes that the recording cannot separate from others (undecided.h). */
#include "undecided.h"

#include "causes.h"
#include "diagnose/identify/fit.h"
#include "probability.h"

#include <stdlib.h>

/* A cause is named if its probability, among all sets near the chosen one, is at least this. */
static const double DECIDED = 0.99;

enum { STEPS = 12 };

/* The named member of the lowest probability below DECIDED; H_COUNT if there is none. False: out of memory. */
static bool find_undecided(session *w, evidence_view *view, hypothesis_id *least)
{
    standing of[H_COUNT];
    double lowest = DECIDED;
    *least = H_COUNT;
    if (!evidence_look(&w->fitted, &w->state, w->possible, view) ||
        !probability_of(view, &w->state, w->possible, w->certainty.inflation, of)) {
        return false;
    }
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set), h) && of[h].probability < lowest) {
            lowest = of[h].probability;
            *least = h;
        }
    }
    return true;
}

bool undecided_take_out(session *w, const diagnose_teller *teller)
{
    evidence_view *view = calloc(1, sizeof *view);
    bool ok = view != NULL;
    w->undecided = 0;
    w->open = w->state;
    while (ok) {
        hypothesis_id h;
        view->stands = false;
        ok = find_undecided(w, view, &h);
        if (!ok || h == H_COUNT) {
            break;
        }
        if (teller->trace) {
            fprintf(teller->trace, "  one of several explanations: %s\n", hypothesis_table[h].words);
        }
        w->undecided |= HYPOTHESIS_BIT(h);
        causes_take_out(&w->state, h, 0, w->frame.of_least);
        ok = fit_refine(&w->fitted, &w->state, STEPS) && certainty_of(&w->fitted, &w->state, &w->certainty);
    }
    free(view);
    return ok;
}

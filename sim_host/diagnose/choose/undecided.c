/* Takes out causes that the recording cannot separate from others (undecided.h). */
#include "undecided.h"

#include "causes.h"
#include "diagnose/identify/fit.h"
#include "probability.h"

#include <math.h>
#include <stdlib.h>

/* A cause is named if its probability, among all sets near the chosen one, is at least this. */
static const double DECIDED = 0.95;
/* Below this it is none, wherever it comes from. */
static const double LIKELY = 0.5;

enum { STEPS = 12 };

/* The named members whose probability among all sets near the state is below the limit. False: out of memory. */
static bool find_below(session *w, double limit, hypothesis_set *below)
{
    standing of[H_COUNT];
    evidence_view *view = calloc(1, sizeof *view);
    bool ok = view && evidence_look(&w->fitted, &w->state, w->possible, view);
    *below = 0;
    if (ok) {
        view->explained = fmax(w->nominal.objective - w->state.objective, 0.0);
        ok = probability_of(view, &w->state, w->possible, w->certainty.inflation, of);
    }
    for (hypothesis_id h = 0; ok && h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set) & ~w->minor, h) && of[h].probability < limit) {
            *below |= HYPOTHESIS_BIT(h);
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
    if (!find_below(w, DECIDED, &undecided)) {
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

bool undecided_accuse_none(session *w, FILE *trace)
{
    hypothesis_set unlikely = 0;
    if (hypotheses_named(w->state.set & ~w->minor) != 0 && !find_below(w, LIKELY, &unlikely)) {
        return false;
    }
    for (hypothesis_id h = 0; trace && h < H_COUNT; h++) {
        if (hypothesis_in(unlikely, h)) {
            fprintf(trace, "  fitted, but less likely than not: %s\n", hypothesis_table[h].words);
        }
    }
    if (unlikely != 0 && w->undecided == 0) {
        w->open = w->state;
    }
    w->minor |= unlikely;
    w->undecided |= unlikely;
    return true;
}

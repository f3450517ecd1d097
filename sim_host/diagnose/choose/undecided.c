/* Takes out causes that the recording cannot separate from others (undecided.h). */
#include "undecided.h"

#include "causes.h"
#include "diagnose/identify/fit.h"
#include "probability.h"

#include <math.h>
#include <stdlib.h>

/* A cause is named if its probability among all sets near the chosen one, and that of the catalogue, are at least this. */
static const double DECIDED = 0.95;
/* Below this it is none, wherever it comes from. */
static const double LIKELY = 0.5;

enum { STEPS = 12 };

/* The named members of the state's set for which a set that is the same drive has another cause. */
static hypothesis_set of_same_drive(const session *w)
{
    const hypothesis_set named = hypotheses_named(w->state.set);
    hypothesis_set found = 0;
    hypothesis_set about;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        for (hypothesis_id other = 0; hypothesis_in(named, h) && other < H_COUNT; other++) {
            const hypothesis_set rest = w->state.set & ~HYPOTHESIS_BIT(h);
            if (hypothesis_in(w->possible, other) && hypothesis_joins(rest, other) &&
                evidence_is_same_drive(&w->state, rest | HYPOTHESIS_BIT(other), &about)) {
                found |= HYPOTHESIS_BIT(h);
            }
        }
    }
    return found;
}

/*
 * The named members whose probability among all sets near the state is below the limit, without minor ones; *same: those of them, minor
 * ones too, whose rival is the same drive. False: out of memory.
 */
static bool find_below(session *w, double limit, hypothesis_set *below, hypothesis_set *same)
{
    standing of[H_COUNT];
    evidence_view *view = calloc(1, sizeof *view);
    bool ok = view && evidence_look(&w->fitted, &w->state, w->possible, view);
    *below = *same = 0;
    if (ok) {
        view->explained = fmax(w->nominal.objective - w->state.objective, 0.0);
        ok = probability_of(view, &w->state, w->possible, w->certainty.inflation, of);
    }
    for (hypothesis_id h = 0; ok && h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(w->state.set), h) && of[h].probability < limit) {
            *below |= HYPOTHESIS_BIT(h);
        }
    }
    if (ok) {
        *same = *below & of_same_drive(w);
        *below &= ~w->minor;
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
    hypothesis_set same;
    w->undecided = 0;
    if (hypotheses_named(w->state.set & ~w->minor) == 0) {
        return true;
    }
    w->open = w->state;
    if (!find_below(w, DECIDED, &undecided, &same)) {
        return false;
    }
    /* One of several numbers of the same drive stays as it is: only what it is called is not known. */
    w->minor |= same;
    w->undecided = same;
    undecided &= ~same;
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
    hypothesis_set same;
    if (hypotheses_named(w->state.set & ~w->minor) != 0 && !find_below(w, LIKELY, &unlikely, &same)) {
        return false;
    }
    if (w->borne_out < DECIDED) {
        unlikely = hypotheses_named(w->state.set & ~w->minor);
    }
    for (hypothesis_id h = 0; trace && h < H_COUNT; h++) {
        if (hypothesis_in(unlikely, h)) {
            fprintf(trace, "  fitted, but not certain enough for a name: %s\n", hypothesis_table[h].words);
        }
    }
    if (unlikely != 0 && w->undecided == 0) {
        w->open = w->state;
    }
    w->minor |= unlikely;
    w->undecided |= unlikely;
    return true;
}

/* A second beginning, where the first left something (reconsider.h). */
#include "reconsider.h"

#include "causes.h"
#include "search.h"

#include "diagnose/identify/revolution.h"
#include "diagnose/measure/errors.h"
#include "diagnose/measure/floor.h"
#include "diagnose/result.h"

#include <stdlib.h>

bool session_leaves_something(const session *w)
{
    double noise = 0.0;
    const averaged_drive drive = session_drive(w, w->state.z);
    const double floor_A = measure_floor(&w->rows, &w->state, &drive, &noise);
    const double left_A =
        0.01 * measure_without_glitches(&w->rows, &drive) * measure_current(&w->rows, MEASURE_ALL, true);
    return floor_A > 0.0 && left_A > DIAGNOSIS_FLOOR_TOLERANCE * floor_A;
}

/* What the effects without a name in a set are called by. */
static hypothesis_set unnamed_of(hypothesis_set set)
{
    hypothesis_set all = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h) && !hypothesis_cause(h)->named) {
            all |= hypotheses_of(hypothesis_table[h].cause);
        }
    }
    return all;
}

bool session_holds_unnamed(const session *w)
{
    return unnamed_of(w->state.set) != 0;
}

bool reconsider(session *w, const diagnose_teller *teller)
{
    const hypothesis_set unnamed = unnamed_of(w->state.set);
    const hypothesis_set again = w->allowed & ~unnamed;
    /* Where nothing stood, the last search has begun without what was dropped already. */
    if (w->state.set == 0 || again == w->possible || again == 0 || fit_has_spent(&w->fitted) ||
        (unnamed == 0 && !session_leaves_something(w))) {
        return true;
    }
    if (teller->trace) {
        fprintf(teller->trace, "  something is left: once more without what did not stay\n");
    }
    const fit_state first = w->state;
    double first_score;
    double score;
    fitted_sets fitted = {0};
    evidence_view *view = calloc(1, sizeof *view);
    w->state = w->nominal;
    const bool ok =
        view && search_best(&w->fitted, &w->state, again, w->nominal.objective, 0.0, &fitted, view, teller) &&
        search_score(&w->fitted, &first, &first_score) && search_score(&w->fitted, &w->state, &score);
    free(view);
    fitted_sets_free(&fitted);
    if (!ok) {
        return false;
    }
    if (score < first_score) {
        return causes_settle(w, teller);
    }
    /* Back, with the stretches' revolutions as they stood under it. */
    bool turned = false;
    w->state = first;
    return revolution_align(&w->fitted, &w->state, w->frame.pole_pairs, &turned);
}

/* Which mending comes when (mending.h). */
#include "mending.h"

#include "choose/reconsider.h"
#include "identify/modulator_choice.h"
#include "identify/speed_lag.h"
#include "measure/floor.h"
#include "measure/link_ripple.h"
#include "measure/missed.h"
#include "measure/sensor_fault.h"

static void say(FILE *trace, size_t rows, const char *what)
{
    if (rows > 0 && trace) {
        fprintf(trace, "  %zu rows mended of %s\n", rows, what);
    }
}

bool mending_by_columns(session *w, const motor *file, hypothesis_set skip, FILE *trace)
{
    size_t rows = 0;
    if (!speed_lag_mend(&w->rows, file, !hypothesis_in(skip, H_SPEED_LAG)) ||
        (!hypothesis_in(skip, H_SENSOR_FAULT) &&
         !measure_sensor_fault(&w->rows, &w->frame.nominal, file, &rows))) {
        return false;
    }
    say(trace, rows, "a sensor's fault");
    return true;
}

bool mending_by_modulator(session *w, FILE *trace, bool *changed)
{
    *changed = false;
    if (!hypothesis_in(w->state.set, H_DEAD_TIME) && w->frame.nominal.v_dead_V == 0.0) {
        return true;
    }
    /* Where wrong edges led the search astray, what it found bends to them: then by a dead time alone. */
    if (!modulator_choose(&w->fitted, &w->state, changed) ||
        (!*changed && session_leaves_something(w) && !modulator_choose(&w->fitted, &w->nominal, changed))) {
        return false;
    }
    if (*changed && trace) {
        fprintf(trace, "  edges by another modulator: %s\n", modulator_words[w->rows.modulator]);
    }
    return true;
}

bool mending_by_rows(session *w, const motor *file, hypothesis_set skip, FILE *trace, size_t *mended)
{
    const averaged_drive first = session_drive(w, w->state.z);
    size_t missed = 0;
    size_t rippled = 0;
    double noise_A = 0.0;
    const bool look_for_missed =
        !hypothesis_in(skip, H_MISSED_UPDATE) && !mending_of(&w->rows, CAUSE_MISSED_UPDATE);
    const bool look_for_ripple =
        !hypothesis_in(skip, H_DC_LINK_RIPPLE) && !mending_of(&w->rows, CAUSE_DC_LINK_RIPPLE);
    if (look_for_missed && !measure_missed(&w->rows, &first, file, &missed)) {
        return false;
    }
    const double floor_A = measure_floor(&w->rows, &w->state, &first, &noise_A);
    if (look_for_ripple && !measure_link_ripple(&w->rows, &first, floor_A, file, &rippled)) {
        return false;
    }
    say(trace, missed, "missed updates");
    say(trace, rippled, "a ripple of the link");
    *mended = missed + rippled;
    return true;
}

bool mending_of(const diagnose_rows *r, cause_id cause)
{
    for (size_t n = 0; n < r->mends; n++) {
        if (r->mend[n].cause == cause) {
            return true;
        }
    }
    return false;
}

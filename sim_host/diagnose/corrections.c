/* Corrections of rows in their order (corrections.h). */
#include "corrections.h"

#include "identify/modulator_choice.h"
#include "identify/speed_lag.h"
#include "measure/floor.h"
#include "measure/link_ripple.h"
#include "measure/missed.h"
#include "measure/sensor_fault.h"
#include "result.h"

#include <stdlib.h>
#include <string.h>

static void say(const session *w, size_t rows, const char *what)
{
    if (rows > 0) {
        session_trace(w, "  %zu rows corrected for %s\n", rows, what);
    }
}

bool corrections_by_columns(session *w)
{
    size_t rows = 0;
    if (!speed_lag_correct(&w->rows, w->file, !hypothesis_in(w->skip, H_SPEED_LAG)) ||
        (!hypothesis_in(w->skip, H_SENSOR_FAULT) &&
         !measure_sensor_fault(&w->rows, &w->frame.nominal, w->file, &rows))) {
        return false;
    }
    say(w, rows, "sensor faults");
    return true;
}

/* The share of the error that another modulator must remove if the edges' effect is only assumed. */
static const double GUESSED = 0.05;

/* The effects, in the set or in the motor file, that depend on the instants of the edges. */
static unsigned seen_by(const session *w)
{
    const averaged_drive *file = &w->frame.nominal;
    unsigned by = 0;
    by |=
        hypotheses_hold(w->state.set, CAUSE_DEAD_TIME) || averaged_drive_loses(file) ? EDGES_BY_DEAD_TIME : 0;
    by |= hypothesis_in(w->state.set, H_SENSOR_LAG) || file->sensor_lag_s != 0.0 ? EDGES_BY_SENSOR_LAG : 0;
    by |= hypothesis_in(w->state.set, H_IRON_LOSS) || file->fe_S != 0.0 ? EDGES_BY_IRON : 0;
    return by;
}

bool corrections_by_modulator(session *w, bool *changed)
{
    const unsigned by = seen_by(w);
    *changed = false;
    if (w->rows.recording->duty[0]) {
        return true;
    }
    if (by != 0 && !modulator_choose(&w->fitted, &w->state, by, 0.0, changed)) {
        return false;
    }
    /* Wrong edges may have misled the search: try without the other causes, or with an effect that may be missing. */
    if (!*changed && (session_holds_unnamed(w) || session_leaves(w, DIAGNOSIS_FLOOR_TOLERANCE))) {
        const unsigned missing = EDGES_BY_SENSOR_LAG | EDGES_BY_IRON;
        if (!modulator_choose(&w->fitted, &w->nominal, by != 0 ? by : missing, by != 0 ? 0.0 : GUESSED,
                              changed) ||
            (!*changed && !modulator_choose(&w->fitted, &w->state, by | missing, GUESSED, changed))) {
            return false;
        }
    }
    if (*changed) {
        session_trace(w, "  modulator changed to: %s\n", modulator_words[w->rows.modulator]);
    }
    return true;
}

bool corrections_by_rows(session *w, size_t *corrected)
{
    const averaged_drive first = session_drive(w, w->state.z);
    size_t faulty = 0;
    size_t missed = 0;
    size_t rippled = 0;
    double noise_A = 0.0;
    const bool look_for_fault =
        !hypothesis_in(w->skip, H_SENSOR_FAULT) && !corrections_of(&w->rows, CAUSE_SENSOR_FAULT);
    const bool look_for_missed =
        !hypothesis_in(w->skip, H_MISSED_UPDATE) && !corrections_of(&w->rows, CAUSE_MISSED_UPDATE);
    const bool look_for_ripple =
        !hypothesis_in(w->skip, H_DC_LINK_RIPPLE) && !corrections_of(&w->rows, CAUSE_DC_LINK_RIPPLE);
    if (look_for_fault && !measure_sensor_fault(&w->rows, &first, w->file, &faulty)) {
        return false;
    }
    if (look_for_missed && !measure_missed(&w->rows, &first, w->file, &missed)) {
        return false;
    }
    const double floor_A = measure_floor(&w->rows, &w->state, &first, &noise_A);
    if (look_for_ripple &&
        !measure_link_ripple(&w->rows, &first, floor_A, LINK_RIPPLE_LEAST, w->file, &rippled)) {
        return false;
    }
    say(w, faulty, "sensor faults");
    say(w, missed, "missed updates");
    say(w, rippled, "DC-link ripple");
    *corrected = faulty + missed + rippled;
    return true;
}

bool corrections_by_link(session *w)
{
    size_t rows = 0;
    if (!hypothesis_in(w->skip, H_DC_LINK_RIPPLE) &&
        !measure_link_ripple(&w->rows, &w->frame.nominal, 0.0, LINK_RIPPLE_ALONE, w->file, &rows)) {
        return false;
    }
    say(w, rows, "DC-link ripple, which by itself explains most");
    return true;
}

bool corrections_take_back(diagnose_rows *r)
{
    size_t kept = 0;
    while (kept < r->corrections && r->correction[kept].cause != CAUSE_MISSED_UPDATE &&
           r->correction[kept].cause != CAUSE_DC_LINK_RIPPLE) {
        kept++;
    }
    if (kept == r->corrections) {
        return false;
    }
    memcpy(r->row, r->correction[kept].before, r->rows * sizeof *r->row);
    while (r->corrections > kept) {
        free(r->correction[--r->corrections].before);
    }
    return true;
}

bool corrections_of(const diagnose_rows *r, cause_id cause)
{
    for (size_t n = 0; n < r->corrections; n++) {
        if (r->correction[n].cause == cause) {
            return true;
        }
    }
    return false;
}

/* Errors of the state, and what they leave (session.h). */
#include "session.h"

#include "diagnose/measure/errors.h"
#include "diagnose/measure/floor.h"
#include "diagnose/measure/runs.h"

#include <math.h>

double session_floor(const session *w, const fit_state *s)
{
    double noise_A = 0.0;
    const averaged_drive drive = coordinates_drive(&w->frame, s->z, s->edge);
    const double floor_A = measure_floor(&w->rows, s, &drive, &noise_A);
    return 100.0 * floor_A / measure_current(&w->rows, MEASURE_ALL, true);
}

static averaged_drive named_drive(const session *w, hypothesis_set set)
{
    double z[P_COUNT] = {0};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(hypotheses_named(set), h)) {
            session_adopt(w, h, z);
        }
    }
    return session_drive(w, z);
}

double session_named_error(const session *w, hypothesis_set set)
{
    const averaged_drive drive = named_drive(w, set);
    return measure_without_glitches(&w->rows, &drive);
}

/* An open-loop error may grow by this factor, in addition to the noise floor. */
static const double WORSE = 1.1;
/* Percent; above it the simulation has diverged. */
static const double DIVERGED = 1e4;

bool session_raises_open_loop(const session *w)
{
    double before[ROWS_MAX_GROUPS] = {0};
    double after[ROWS_MAX_GROUPS] = {0};
    const averaged_drive drive = named_drive(w, w->state.set);
    const double floor_A = 0.01 * session_floor(w, &w->state) * measure_current(&w->rows, MEASURE_ALL, true);
    const bool by_sign = drive.compensation_V != 0.0 && drive.v_dead_V < 0.0;
    if (by_sign || isnan(measure_open_loop(&w->rows, &w->frame.nominal, before)) ||
        isnan(measure_open_loop(&w->rows, &drive, after))) {
        return false;
    }
    for (size_t g = 0; g < w->rows.groups; g++) {
        const double floor = 100.0 * floor_A / measure_current(&w->rows, g, false);
        if (after[g] > WORSE * before[g] + floor && after[g] < DIVERGED) {
            return true;
        }
    }
    return false;
}

bool session_holds_unnamed(const session *w)
{
    return w->state.set != hypotheses_named(w->state.set);
}

bool session_leaves(const session *w, double floors)
{
    const averaged_drive drive = session_drive(w, w->state.z);
    const double floor = session_floor(w, &w->state);
    return floor > 0.0 && measure_without_glitches(&w->rows, &drive) > floors * floor;
}

/* So much of the nominal model's error, as power above the noise floor, may be left. */
static const double LEFT_MOST = 0.25;

bool session_explains_most(const session *w, const fit_state *s, double percent)
{
    const double floor = fmin(session_floor(w, s), percent);
    const double nominal = session_named_error(w, 0);
    return percent * percent - floor * floor <= LEFT_MOST * (nominal * nominal - floor * floor);
}

/* Errors of the state, and what they leave (session.h). */
#include "session.h"

#include "identify/last_digits.h"
#include "measure/errors.h"
#include "measure/floor.h"
#include "measure/plain_knee.h"
#include "measure/runs.h"
#include "weigh/borne_out.h"
#include "weigh/discrepancy.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

double session_scale_doubt(const session *w, hypothesis_id h)
{
    double doubt = 0.0;
    for (size_t k = 0; k < HYPOTHESES_SCALED; k++) {
        const bool scales = hypothesis_table[hypotheses_scaled[k]].cause == hypothesis_table[h].cause;
        for (size_t which = 0; scales && which < DRIVE_SCALES; which++) {
            doubt += (which >> k & 1U) == 0 ? w->scale[which].share : 0.0;
        }
    }
    return doubt;
}

hypothesis_set session_rivals(const session *w)
{
    hypothesis_set scaled = 0;
    double weighed = 0.0;
    for (size_t which = 0; which < DRIVE_SCALES; which++) {
        weighed += w->scale[which].share;
    }
    for (hypothesis_id h = 0; weighed > 0.0 && h < H_COUNT; h++) {
        scaled |= hypothesis_is_scaled(h) ? HYPOTHESIS_BIT(h) : 0;
    }
    return w->possible & ~(scaled & ~w->state.set);
}

void session_trace(const session *w, const char *format, ...)
{
    if (w->teller.trace) {
        va_list args;
        va_start(args, format);
        vfprintf(w->teller.trace, format, args);
        va_end(args);
    }
}

bool session_look(session *w)
{
    const bool ok = evidence_look(&w->fitted, &w->state, w->possible, &w->view);
    w->view.explained = fmax(w->nominal.objective - w->state.objective, 0.0);
    return ok;
}

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

/*
 * Even with perfect sensors, duties are quantised, the speed is not constant within the cycle and the ripple is not symmetric. A dead
 * time near zero current has no exact model; its model error affects the other causes.
 *
 * From blind seeds 1000 to 1299 and 20000 to 20299: 91 % of 877 intervals contained the true value with all these at zero, 97 %
 * with them. Of 364 intervals together with a dead time (with each other cause eight times, and a hundred alone): 88 % without
 * the second pair, 96 % with it. Of 839 of whole drives on benches 97 % without the second pair.
 */
static const session_strays USUAL = {0.006, 0.0006};
static const session_strays BESIDE_DEAD_TIME = {0.3, 0.006};

session_strays session_model_strays(const session *w, cause_id cause)
{
    if (w->way == SESSION_WHOLE_DRIVE || !hypotheses_hold(w->state.set, CAUSE_DEAD_TIME)) {
        return USUAL;
    }
    /* Its own size is better known. */
    return (session_strays){cause == CAUSE_DEAD_TIME ? USUAL.of_least : BESIDE_DEAD_TIME.of_least,
                            BESIDE_DEAD_TIME.of_effect};
}

bool session_is_large(const session *w, hypothesis_id h)
{
    const session_strays strays = session_model_strays(w, hypothesis_table[h].cause);
    const double least = w->frame.of_least * hypothesis_table[h].least;
    return !hypothesis_size_is_doubted(h) ||
           certainty_exceeds(&w->certainty, &w->state, h, (1.0 + strays.of_least) * least);
}

double session_named_error(const session *w, hypothesis_set set)
{
    const averaged_drive drive = named_drive(w, set);
    return measure_without_glitches(&w->rows, &drive);
}

double session_borne_out(session *w, const diagnose_rows *from)
{
    /* What a file's own dead time leaves near no current, by the plain law that a file has, is no effect outside the catalogue. */
    if (averaged_drive_loses(&w->frame.nominal)) {
        return borne_out_probability(0.0);
    }
    const averaged_drive all = session_drive(w, w->state.z);
    const averaged_drive drive = named_drive(w, w->state.set);
    const double floor = fmin(session_floor(w, &w->state), measure_without_glitches(&w->rows, &all));
    const double one_cycle = borne_out_left(measure_without_glitches(from, &w->frame.nominal),
                                            measure_without_glitches(&w->rows, &drive), floor);
    const double open_loop = borne_out_left(measure_open_loop(from, &w->frame.nominal, NULL),
                                            measure_open_loop(&w->rows, &drive, NULL), floor);
    const bool rises = open_loop > 1.0 && !plain_knee_holds_sign(&drive, &w->rows, w->frame.i_rated_peak_A);
    const double left = rises ? open_loop : fmin(one_cycle, open_loop);
    if (isnan(left) || (hypotheses_named(w->state.set) == 0 && from == &w->rows)) {
        return borne_out_probability(left);
    }
    /* What is within the file's tolerance is no discrepancy. */
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    hypotheses_leave(w->state.set & ~hypotheses_named(w->state.set), z);
    const averaged_drive tolerant = session_drive(w, z);
    return borne_out_probability(fmax(left, discrepancy_share(&w->fitted, &w->state, &tolerant, from)));
}

bool session_holds_unnamed(const session *w)
{
    return w->state.set != hypotheses_named(w->state.set);
}

bool session_leaves(const session *w, double floors)
{
    /* A tolerance that was strained is no explanation. */
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    last_digits_bound(w->state.set, z);
    const averaged_drive drive = session_drive(w, z);
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

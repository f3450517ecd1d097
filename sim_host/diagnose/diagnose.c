/* The page on top: a recording's way through check, identify, measure, choose and tell (diagnose.h). */
#include "diagnose.h"

#include "base/number.h"
#include "check/columns.h"
#include "check/current_sum.h"
#include "check/motor_file.h"
#include "check/polarity.h"
#include "check/values.h"
#include "check/wiring.h"
#include "choose/causes.h"
#include "choose/likely_drive.h"
#include "choose/undecided.h"
#include "choose/whole_drive.h"
#include "corrections.h"
#include "identify/corrected_rows.h"
#include "identify/fit.h"
#include "identify/last_digits.h"
#include "identify/revolution.h"
#include "identify/row_edges.h"
#include "learn/learned.h"
#include "measure/errors.h"
#include "measure/floor.h"
#include "measure/glitches.h"
#include "measure/lines.h"
#include "measure/plain_knee.h"
#include "measure/runs.h"
#include "measure/sum_line.h"
#include "next/experiment.h"
#include "tell/advice.h"
#include "tell/corrected_causes.h"
#include "tell/known.h"
#include "tell/named.h"
#include "tell/resistance_trade.h"
#include "tell/sentence.h"
#include "tell/visible.h"
#include "weigh/confusion.h"
#include "weigh/probability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Of a longer recording, evenly spread blocks are fitted, and all others measure the error. Of 112 development recordings of benches and
 * of one to three causes, as many are right by 5,000 rows as by 8,800, in two thirds of the time or less; of 14 other benches, two fewer.
 */
enum { SEARCH_ROWS = 5000 };

_Static_assert((int)H_COUNT <= (int)DIAGNOSIS_HYPOTHESES, "a row of the table for each hypothesis");
_Static_assert(H_COUNT <= 8 * sizeof(hypothesis_set), "a bit for each hypothesis");

/* Residual structure with a smaller share of the error's power is not reported. */
static const double STRUCTURE_SHARE = 0.05;

/* An error of this many noise floors and percent starts the check for a wrong motor file. Glitches and loose sensors stay below. */
static const double SUSPECT = 2.0;
static const double FAR_OFF = 15.0;

/* An open-loop simulation with this error in percent has diverged. */
static const double LOST = 1e4;

/* By which share an error's power falls; 0 if a simulation diverged. */
static double falls_by(double before, double after)
{
    const double share = 1.0 - after * after / (before * before);
    return isnan(share) ? 0.0 : share;
}

/* An unnamed hypothesis that was chosen is reported as residual structure if its share is large enough. */
static void mention_decoys(const session *w, diagnosis *d)
{
    averaged_drive all = session_drive(w, w->state.z);
    const double share = fmax(falls_by(d->extended, measure_one_cycle(&w->rows, &all, MEASURE_ALL, true)),
                              falls_by(d->free_extended_percent, measure_open_loop(&w->rows, &all, NULL)));
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((w->state.set & HYPOTHESIS_BIT(h)) && !hypothesis_cause(h)->named && share > STRUCTURE_SHARE) {
            size_t used = strlen(d->structure.words);
            d->structure.certain = true;
            if (!hypothesis_table[h].silent) {
                snprintf(d->structure.words + used, sizeof d->structure.words - used, "%sit resembles %s",
                         used ? "; " : "", hypothesis_table[h].words);
            } else if (used == 0) {
                snprintf(d->structure.words, sizeof d->structure.words, "no cause of the list explains it");
            }
        }
    }
}

/* If the best causes leave more than they explain, that is residual structure as well. */
static void mention_more_left(const session *w, diagnosis *d)
{
    if (w->more_left) {
        const size_t used = strlen(d->structure.words);
        d->structure.certain = true;
        snprintf(d->structure.words + used, sizeof d->structure.words - used,
                 "%sthe best set of causes leaves more than it explains", used ? "; " : "");
    }
}

static bool tabulate_hypotheses(session *w, evidence_view *view, diagnosis *d, const hypothesis_id *member,
                                hypothesis_set skipped)
{
    confusion_find(d, view, &w->state, member, w->possible, w->certainty.inflation);
    confusion_trades(d, view, &w->state, member, w->possible, w->certainty.inflation);
    known_tell(w, view, d);
    standing of[H_COUNT];
    if (!probability_of(view, &w->state, session_rivals(w), w->certainty.inflation, &w->fitted, &w->rivals,
                        of)) {
        return false;
    }
    for (size_t k = 0; k < d->causes; k++) {
        d->cause[k].probability =
            w->borne_out * of[member[k]].probability * (1.0 - session_scale_doubt(w, member[k]));
    }
    evidence_option own;
    evidence_option none;
    evidence_cost(view, &w->state, w->state.set, &own);
    evidence_cost(view, &w->state, 0, &none);
    for (hypothesis_id h = 0; h < H_COUNT && d->hypotheses < DIAGNOSIS_HYPOTHESES; h++) {
        diagnosis_hypothesis *row = &d->hypothesis[d->hypotheses++];
        evidence_option alone;
        evidence_option more;
        *row = (diagnosis_hypothesis){
            .id = hypothesis_cause(h)->id,
            .words = hypothesis_table[h].words,
            .named = ((w->state.set & HYPOTHESIS_BIT(h)) && hypothesis_cause(h)->named) ||
                     corrections_of(&w->rows, hypothesis_table[h].cause),
            .possible = (w->possible & HYPOTHESIS_BIT(h)) != 0,
            .skipped = (skipped & HYPOTHESIS_BIT(h)) != 0};
        evidence_cost(view, &w->state, HYPOTHESIS_BIT(h), &alone);
        if (none.cost > own.cost) {
            row->alone = fmin(fmax((none.cost - alone.cost) / (none.cost - own.cost), 0.0), 1.0);
        }
        if (hypothesis_joins(w->state.set, h)) {
            evidence_cost(view, &w->state, w->state.set | HYPOTHESIS_BIT(h), &more);
            row->beyond = fmax(own.cost - more.cost, 0.0);
        }
    }
    return true;
}

/* Tabulates hypotheses and the next recording from the sums at the found state. */
static bool tell_hypotheses(session *w, diagnosis *d, const hypothesis_id *member, hypothesis_set skipped)
{
    evidence_view *view = &w->view;
    if (!session_look(w) || !tabulate_hypotheses(w, view, d, member, skipped) ||
        !resistance_trade_tell(w, d)) {
        return false;
    }
    visible_tell(w, view, d);
    d->reliable = d->verdict == VERDICT_CLEAN || d->verdict == VERDICT_EXPLAINED;
    known_widen(d);
    if (w->undecided != 0) {
        explanations_tell(w, view, hypotheses_named(w->state.set) & ~w->undecided, d);
        if (!d->alike_by_scale) {
            experiment_of_explanations(w, view, w->undecided, d);
        }
    }
    if (d->experiment.numbers == 0) {
        experiment_find(w, view, member, d);
    }
    return true;
}

/* In noise floors. */
static const double WITHIN_DIGITS = 2.0;
/* If the open-loop simulation gets worse by this factor, beyond the noise, the recording is not explained. */
static const double FREE_RUN_WORSE = 1.1;

/* An error within the parameter tolerance of the motor file is no structure, as long as it is of the noise's size. */
static bool at_the_noise(const diagnosis *d, double percent)
{
    return diagnosis_at_floor(d, percent) ||
           (diagnosis_at_floor(d, d->within_digits) && percent <= WITHIN_DIGITS * d->noise_floor);
}

/* Both values as measured; a diverged simulation has a very large one. It does not count where noise decides the sign of a current. */
static bool free_run_holds(const session *w, const diagnosis *d)
{
    return d->free_extended_percent <= FREE_RUN_WORSE * d->free_nominal_percent + d->noise_floor ||
           plain_knee_holds_sign(&d->extended_drive, &w->rows, w->frame.i_rated_peak_A);
}

/* Percent of the current: a model that errs by more predicts little of it, however large the noise is. */
static const double LITTLE_PREDICTED = 50.0;

static void decide(const session *w, diagnosis *d)
{
    if (d->causes == 0 && w->rows.corrections == 0) {
        d->verdict =
            at_the_noise(d, d->nominal) && !d->structure.certain ? VERDICT_CLEAN : VERDICT_UNEXPLAINED;
        return;
    }
    const bool holds = free_run_holds(w, d);
    d->verdict =
        at_the_noise(d, d->extended) && !d->structure.certain && holds && d->extended < LITTLE_PREDICTED
            ? VERDICT_EXPLAINED
            : VERDICT_PARTLY;
    if (!holds) {
        char nominal[NUMBER_TEXT_SIZE];
        char extended[NUMBER_TEXT_SIZE];
        const size_t used = strlen(d->structure.words);
        snprintf(d->structure.words + used, sizeof d->structure.words - used,
                 isnan(d->free_nominal_percent) || isnan(d->free_extended_percent)
                     ? "%sopen-loop error: nominal model %s, extended model %s"
                     : "%sthe open-loop error grew from %s to %s",
                 used ? "; " : "", number_percent(d->free_nominal_percent, nominal),
                 number_percent(d->free_extended_percent, extended));
    }
}

/* The size of a diverged open-loop error has no meaning. */
static double told_free_run(double percent)
{
    return percent < LOST ? percent : NAN;
}

static void bound_runs(diagnosis *d)
{
    d->free_nominal_percent = told_free_run(d->free_nominal_percent);
    d->free_extended_percent = told_free_run(d->free_extended_percent);
    for (size_t g = 0; g < d->runs; g++) {
        d->run[g].free_nominal = told_free_run(d->run[g].free_nominal);
        d->run[g].free_extended = told_free_run(d->run[g].free_extended);
    }
}

/* The error of the named causes, with all parameters free within their tolerance and without unnamed effects. */
static double error_within_digits(const session *w)
{
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    last_digits_bound(w->state.set, z);
    hypotheses_leave(w->state.set & ~hypotheses_named(w->state.set), z);
    const averaged_drive drive = session_drive(w, z);
    return measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
}

static double error_with(const diagnose_rows *r, const averaged_drive *drive)
{
    return measure_one_cycle(r, drive, MEASURE_ALL, true);
}

/* Causes that leave more than all effects of the catalogue would are not named. */
static const double LIKELY = 0.5;

static bool leave_unlikely(session *w)
{
    const diagnose_rows recorded = corrected_rows_before(&w->rows, 0);
    w->borne_out = session_borne_out(w, &w->rows);
    w->corrections_borne_out = session_borne_out(w, &recorded);
    session_trace(w, "  probability of the catalogue: %.4f, with the corrections of rows %.4f\n",
                  w->borne_out, w->corrections_borne_out);
    const bool drops =
        w->borne_out < LIKELY && (hypotheses_named(w->state.set) != 0 || w->rows.corrections > 0);
    const bool taken_back = drops && w->corrections_borne_out < LIKELY && corrections_take_back(&w->rows);
    if (!taken_back && (!drops || hypotheses_named(w->state.set) == 0)) {
        return true;
    }
    w->view.stands = w->view.stands && !taken_back;
    if (taken_back && !fit_of_nominal(&w->fitted, &w->nominal)) {
        return false;
    }
    w->state = w->nominal;
    w->minor = w->undecided = 0;
    w->more_left = true;
    return certainty_of(&w->fitted, &w->state, &w->certainty);
}

/* Starts from the motor file's values. */
static bool begin(session *w)
{
    bool turned = false;
    return fit_of_nominal(&w->fitted, &w->nominal) &&
           (!revolution_in_file(&w->fitted) ||
            revolution_align(&w->fitted, &w->nominal, w->frame.pole_pairs, &turned)) &&
           (!turned || fit_of_nominal(&w->fitted, &w->nominal)) && causes_find(w);
}

/* A fit's noise is less than the rows' if it is so much less. */
static const double LESS_NOISE = 0.8;
enum { DOUBT_STEPS = 12 };

/*
 * The noise by which signs are doubted is at first that of the currents' differences, and the ripple of a dead time is a part of these.
 * Where a compensation was found, its fit knows better, and what was left out near zero current may be the compensation itself. *less:
 * the set was fitted again with less noise.
 */
static bool doubt_less(session *w, bool *less)
{
    const double noise_A = measure_phase_noise(&w->rows, &w->state);
    *less = hypothesis_in(w->state.set, H_COMPENSATED) && noise_A < LESS_NOISE * w->rows.noise_A;
    if (!*less) {
        return true;
    }
    session_trace(w, "  noise of a phase's current %.3g A in place of %.3g A\n", noise_A, w->rows.noise_A);
    w->rows.noise_A = noise_A;
    coordinates_doubt(&w->frame, &w->rows);
    return fit_refine(&w->fitted, &w->state, DOUBT_STEPS) &&
           certainty_of(&w->fitted, &w->state, &w->certainty);
}

/* Largest error of a sparse set, in noise floors; above it the drive has more causes. */
static const double LEAVES_MORE = 1.05;
/* This many causes are rare on a drive that the model otherwise describes exactly. */
enum { MANY = 3 };

/* Whether what was found probably is what acts, but not as surely as a name needs: then smaller effects act as well. */
static bool is_almost_explained(session *w)
{
    const double probability = hypotheses_named(w->state.set) != 0 ? session_borne_out(w, &w->rows) : 1.0;
    return probability >= LIKELY && probability < UNDECIDED_NAMED;
}

/*
 * Fits the whole drive if the search leaves a residual, or found an unnamed effect, a flux map, a compensation or many causes, or almost
 * explains the recording. A drive that compensates its dead time is a bench, on which everything is a little off.
 */
static bool consider_whole(session *w)
{
    size_t members = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        members += hypothesis_in(w->state.set, h) ? 1 : 0;
    }
    const bool wanted = w->way == SESSION_WHOLE_DRIVE || members >= MANY || session_leaves(w, LEAVES_MORE) ||
                        session_holds_unnamed(w) || hypotheses_hold(w->state.set, CAUSE_SATURATION_DQ) ||
                        hypothesis_in(w->state.set, H_COMPENSATED) || is_almost_explained(w);
    return !wanted || whole_drive_consider(w);
}

/* After a correction of rows, or of their noise: a set of the whole drive is fitted again from its state, a sparse search restarts. */
static bool go_on(session *w)
{
    w->view.stands = false;
    return (w->way == SESSION_WHOLE_DRIVE ? fit_of_nominal(&w->fitted, &w->nominal) : begin(w)) &&
           consider_whole(w);
}

/* As a cause, a correction must lower the held-out error. The peaks of a ripple can look like missed updates to a drive that is wrong. */
static bool missed_in_vain(const session *w)
{
    const averaged_drive drive = session_drive(w, w->state.z);
    for (size_t n = 0; n < w->rows.corrections; n++) {
        if (w->rows.correction[n].cause == CAUSE_MISSED_UPDATE) {
            return measure_gain_of_correction(&w->rows, n, &drive) < 1.0;
        }
    }
    return false;
}

/* A correction may uncover more: DC-link ripple hides missed updates. */
static bool correct_rows(session *w)
{
    /* A ripple that the motor file's drive showed is measured again by the drive that was found since. */
    bool changed = w->state.set != 0 && corrections_take_back(&w->rows);
    size_t corrected = 1;
    for (int again = 0; corrected > 0 && again < 2; again++) {
        if (!corrections_by_rows(w, &corrected) || ((corrected > 0 || changed) && !go_on(w))) {
            return false;
        }
        changed = false;
    }
    if (!missed_in_vain(w)) {
        return true;
    }
    session_trace(w, "  taken back, as it raises the error: the correction for missed updates\n");
    w->skip |= HYPOTHESIS_BIT(H_MISSED_UPDATE);
    corrections_take_back(&w->rows);
    return corrections_by_rows(w, &corrected) && go_on(w);
}

/* Causes that were rejected may have hidden an effect that rows can be corrected for. */
static bool correct_remaining_rows(session *w)
{
    size_t corrected = 0;
    if (!corrections_by_rows(w, &corrected)) {
        return false;
    }
    if (corrected == 0) {
        return true;
    }
    w->more_left = false;
    return begin(w) && causes_bear_out(w);
}

/* Where other causes act, another modulator may only seem to fit: it stays if the search, or the fit of the whole drive, ends better. */
static bool find_under_modulator(session *w)
{
    const modulator own = w->rows.modulator;
    const fit_state state = w->state;
    const fit_state nominal = w->nominal;
    const certainty certainty_found = w->certainty;
    const hypothesis_set allowed = w->allowed;
    drive_scale scale[DRIVE_SCALES];
    bool changed = false;
    memcpy(scale, w->scale, sizeof scale);
    if (!corrections_by_modulator(w, &changed) ||
        (changed && !(w->way == SESSION_WHOLE_DRIVE ? go_on(w) : begin(w)))) {
        return false;
    }
    if (changed && w->state.objective >= state.objective) {
        rows_fill_edges(&w->rows, w->frame.motor, own);
        w->view.stands = false;
        w->state = state;
        w->nominal = nominal;
        w->certainty = certainty_found;
        w->allowed = allowed;
        memcpy(w->scale, scale, sizeof scale);
        session_trace(w, "  modulator changed back: the search ended worse\n");
    }
    return true;
}

/* Glitches disturb every estimate: they are left out, and the search repeats. */
static bool leave_glitches_out(session *w, size_t *glitches)
{
    *glitches = measure_glitches(&w->fitted, &w->state);
    if (*glitches == 0) {
        return true;
    }
    w->view.stands = false;
    session_trace(w, "  %zu glitches left out, search repeated\n", *glitches);
    return fit_gains(&w->fitted, &w->nominal) && (w->way == SESSION_WHOLE_DRIVE || causes_find(w)) &&
           consider_whole(w);
}

/* The drive that fits best, by the search or as a whole, on corrected rows. */
static bool find_drive(session *w, size_t *glitches)
{
    bool less = false;
    w->fitted.searches = true;
    if (!corrections_by_link(w) || !begin(w) || !doubt_less(w, &less) || !find_under_modulator(w) ||
        !consider_whole(w)) {
        return false;
    }
    /* The search's drive may have been too wrong to show the modulator. */
    if (w->way == SESSION_WHOLE_DRIVE && !find_under_modulator(w)) {
        return false;
    }
    /* What a sparse search found by too much noise may be wrong. */
    return (!less || w->way == SESSION_WHOLE_DRIVE || go_on(w)) && correct_rows(w) &&
           leave_glitches_out(w, glitches);
}

/* Which of its effects are causes, which are minor, and which are not known to be either. */
static bool name_causes(session *w)
{
    if (w->way == SESSION_WHOLE_DRIVE ? !whole_drive_divide(w)
                                      : !causes_bear_out(w) || (w->more_left && !correct_remaining_rows(w)) ||
                                            !causes_reject_harmful(w) || !causes_split_saturation(w)) {
        return false;
    }
    if (!likely_drive_fit(w)) {
        return false;
    }
    w->best = w->state;
    if (!leave_unlikely(w) ||
        (w->way != SESSION_LIKELY_DRIVE && !undecided_accuse_none(w, UNDECIDED_NAMED))) {
        return false;
    }
    /* Probabilities and tables describe the state itself, without a search from there. */
    w->fitted.searches = false;
    return undecided_accuse_none(w, UNDECIDED_LIKELY);
}

/* Errors, noise floor and residual structure of the named model, and the verdict. */
static bool measure(session *w, diagnosis *d, bool series)
{
    const diagnose_rows recorded = corrected_rows_before(&w->rows, 0);
    const double current = measure_current(&w->rows, MEASURE_ALL, true);
    d->nominal = error_with(&recorded, &d->nominal_drive);
    d->extended = error_with(&w->rows, &d->extended_drive);
    d->noise_floor =
        100.0 * measure_floor(&w->rows, &w->state, &d->extended_drive, &d->sensor_noise_A) / current;
    d->noise_floor = fmin(d->noise_floor, d->extended);
    d->within_digits = error_within_digits(w);
    d->gain = d->extended > 0.0 ? d->nominal / d->extended : 1.0;
    const double excess = (at_the_noise(d, d->extended) ? d->within_digits : d->extended) / d->noise_floor;
    if (!measure_lines(&w->fitted, &w->state, excess, &d->structure) || !measure_runs(&w->rows, d, series)) {
        return false;
    }
    mention_decoys(w, d);
    mention_more_left(w, d);
    if (!sum_line_tell(&w->rows, &d->extended_drive, d->sensor_noise_A, &d->structure)) {
        return false;
    }
    decide(w, d);
    if ((d->verdict == VERDICT_PARTLY || d->verdict == VERDICT_UNEXPLAINED) && !learned_find(&w->rows, d)) {
        return false;
    }
    bound_runs(d);
    return true;
}

static void count_rows(const diagnose_rows *r, diagnosis *d)
{
    d->rows_clipped = r->clipped;
    for (size_t b = 0; b < r->blocks; b++) {
        d->rows_used += r->block[b].count;
        d->rows_held_out += r->block[b].held_out ? r->block[b].count : 0;
    }
}

static bool work(session *w, diagnosis *d, const diagnose_options *options)
{
    hypothesis_id member[DIAGNOSIS_CAUSES] = {0};
    w->possible = hypotheses_possible(&w->rows, &w->frame) & ~w->skip;
    if (!find_drive(w, &d->outliers) || !name_causes(w)) {
        return false;
    }
    session_trace(w, "  rows predicted in the search: %.2g\n", w->fitted.effort);
    d->nominal_drive = w->frame.nominal;
    d->extended_motor = *w->file;
    named_tell(w, d, member);
    if (!measure(w, d, options->series) || !tell_hypotheses(w, d, member, options->skip)) {
        return false;
    }
    corrected_causes_tell(&w->rows, w->file, w->corrections_borne_out, d);
    advice_tell(w, d);
    sentence_tell(d);
    count_rows(&w->rows, d);
    return true;
}

bool diagnose(diagnosis *d, const recording *rec, const motor *m, const diagnose_options *options, error *e)
{
    memset(d, 0, sizeof *d);
    d->recording_path = rec->path;
    d->motor_path = m->path;
    d->rows = rec->rows;
    session *w = calloc(1, sizeof *w);
    if (!w) {
        return error_failure(e, 0, "out of memory");
    }
    bool ok = check_values(rec, e) && check_columns(rec, m, e) && check_speed(rec, e) &&
              check_current_sum(rec, e) && check_polarity(rec, e) && rows_prepare(&w->rows, rec, m, e);
    if (ok && measure_current(&w->rows, MEASURE_ALL, true) == 0.0) {
        ok = error_input(e, rec->path, 0, 0,
                         "no current flows in the held-out rows, and errors are in percent of the current; "
                         "record with current in every run");
    }
    if (ok) {
        w->rows.no_memory = &w->no_memory;
        w->file = m;
        w->skip = options->skip;
        w->teller = options->teller;
        w->frame = coordinates_of(m, &w->rows);
        w->frame.of_least = options->any_size ? 0.0 : 1.0;
        ok = (corrections_by_columns(w) || error_failure(e, 0, "out of memory for %zu rows", w->rows.rows)) &&
             fit_data_make(&w->fitted, &w->rows, &w->frame, SEARCH_ROWS, e);
    }
    if (ok && (!work(w, d, options) || w->no_memory)) {
        ok = error_failure(e, 0, "out of memory in the diagnosis of %zu rows", rec->rows);
    }
    if (ok && !isfinite(d->nominal + d->extended + d->noise_floor)) {
        ok = error_input(e, rec->path, 0, 0,
                         "the model error cannot be computed on the held-out rows: the model with the motor "
                         "file's values diverges there; check the motor file");
    }
    if (ok) {
        error other = {0};
        const averaged_drive fitted = coordinates_drive(&w->frame, w->best.z, w->best.edge);
        const bool its = check_motor_file(&fitted, &w->frame.nominal, rec, &other);
        /* Check the wiring if no cause explains the recording, or only another motor does. */
        if (!its || !d->reliable) {
            const bool far_off = d->extended > FAR_OFF && d->extended > SUSPECT * d->noise_floor;
            ok = check_wiring(rec, m, far_off, e);
        }
        if (ok && !its) {
            *e = other;
            ok = false;
        }
    }
    fit_data_free(&w->fitted);
    rows_free(&w->rows);
    free(w);
    if (!ok) {
        diagnosis_free(d);
    }
    return ok;
}

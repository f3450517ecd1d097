/* The page on top: a recording's way through check, identify, measure, choose and tell (diagnose.h). */
#include "diagnose.h"

#include "check/columns.h"
#include "check/current_sum.h"
#include "check/motor_file.h"
#include "check/polarity.h"
#include "check/values.h"
#include "check/wiring.h"
#include "choose/causes.h"
#include "choose/confusion.h"
#include "choose/probability.h"
#include "choose/reconsider.h"
#include "identify/fit.h"
#include "identify/last_digits.h"
#include "identify/mended.h"
#include "identify/revolution.h"
#include "learn/learned.h"
#include "measure/errors.h"
#include "measure/floor.h"
#include "measure/glitches.h"
#include "measure/lines.h"
#include "measure/runs.h"
#include "mending.h"
#include "next/experiment.h"
#include "tell/advice.h"
#include "tell/known.h"
#include "tell/mended_causes.h"
#include "tell/named.h"
#include "tell/resistance_trade.h"
#include "tell/sentence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of more rows evenly spread blocks are searched: the others would cost time and gain nothing. */
enum { SEARCH_ROWS = 12000 };

_Static_assert((int)H_COUNT <= (int)DIAGNOSIS_HYPOTHESES, "a row of the table for each hypothesis");
_Static_assert(H_COUNT <= 8 * sizeof(hypothesis_set), "a bit for each hypothesis");

/* Structure that takes less of the one-cycle error's power does no harm and is not reported. */
static const double STRUCTURE_SHARE = 0.05;

/* An extended error of this many noise floors raises the question whether the columns are what they say. */
static const double SUSPECT = 2.0;
/* And one of this many percent, whether the motor is the one of the file. Glitches and loose sensors stay
 * below. */
static const double FAR_OFF = 15.0;

/* A free run that errs by this many percent of the current does not follow it any more. */
static const double LOST = 1e4;

/* A decoy that was chosen is structure, known to be there but without a name in the list of causes, if it
 * matters. */
static void mention_decoys(const session *w, diagnosis *d)
{
    averaged_drive all = session_drive(w, w->state.z);
    double best = measure_one_cycle(&w->rows, &all, MEASURE_ALL, true);
    double share = 1.0 - best * best / (d->extended * d->extended);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((w->state.set & HYPOTHESIS_BIT(h)) && !hypothesis_cause(h)->named && share > STRUCTURE_SHARE) {
            size_t used = strlen(d->structure.words);
            d->structure.certain = true;
            if (!hypothesis_table[h].silent) {
                snprintf(d->structure.words + used, sizeof d->structure.words - used, "%sit looks like %s",
                         used ? "; " : "", hypothesis_table[h].words);
            } else if (used == 0) {
                snprintf(d->structure.words, sizeof d->structure.words,
                         "no cause of the list accounts for it");
            }
        }
    }
}

/* That the best causes leave more than they explain is known structure, too, however small the error of a cycle is. */
static void mention_more_left(const session *w, diagnosis *d)
{
    if (w->more_left) {
        const size_t used = strlen(d->structure.words);
        d->structure.certain = true;
        snprintf(d->structure.words + used, sizeof d->structure.words - used,
                 "%sthe causes that fit best leave more than they explain", used ? "; " : "");
    }
}

static bool tabulate_hypotheses(const session *w, evidence_view *view, diagnosis *d,
                                const hypothesis_id *member, hypothesis_set skipped)
{
    confusion_find(d, view, &w->state, member, w->possible, w->certainty.inflation);
    confusion_trades(d, view, &w->state, member, w->possible, w->certainty.inflation);
    known_tell(w, view, d);
    standing of[H_COUNT];
    view->explained = fmax(w->nominal.objective - w->state.objective, 0.0);
    if (!probability_of(view, &w->state, w->possible, w->certainty.inflation, of)) {
        return false;
    }
    for (size_t k = 0; k < d->causes; k++) {
        d->cause[k].probability = of[member[k]].probability;
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
                     mending_of(&w->rows, hypothesis_table[h].cause),
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

/* What the sums at the state found say: of the hypotheses, and of what to record next. */
static bool tell_hypotheses(session *w, diagnosis *d, const hypothesis_id *member, hypothesis_set skipped)
{
    evidence_view *view = calloc(1, sizeof *view);
    /* What is told is what holds about the state, not what a search sees from there. */
    w->fitted.searches = false;
    bool ok = view != NULL && evidence_look(&w->fitted, &w->state, w->possible, view);
    if (ok) {
        ok = tabulate_hypotheses(w, view, d, member, skipped) && resistance_trade_tell(w, d);
    }
    if (ok) {
        experiment_find(w, view, member, d);
    }
    free(view);
    return ok;
}

/* In noise floors. */
static const double WITHIN_DIGITS = 2.0;
/* A free run this much worse than the motor file's, beyond the noise, is no explanation. */
static const double FREE_RUN_WORSE = 1.1;

/* What the file's last digits leave unnamed is no structure, as long as it is of the noise's size. */
static bool at_the_noise(const diagnosis *d, double percent)
{
    const double tolerance = DIAGNOSIS_FLOOR_TOLERANCE * d->noise_floor;
    return percent <= tolerance ||
           (d->within_digits <= tolerance && percent <= WITHIN_DIGITS * d->noise_floor);
}

/* Both as measured: a lost one is very large. What goes by the sign of its own current near nought, as an over-compensation
 * does, runs away from any recording at the first sign that noise decided. */
static bool free_run_holds(const diagnosis *d)
{
    const bool by_sign = d->extended_drive.edge == EDGE_OVER && d->extended_drive.v_dead_V < 0.0;
    return by_sign || d->free_extended_percent <= FREE_RUN_WORSE * d->free_nominal_percent + d->noise_floor;
}

static void decide(diagnosis *d, bool mended)
{
    if (d->causes == 0 && !mended) {
        d->verdict =
            at_the_noise(d, d->nominal) && !d->structure.certain ? VERDICT_CLEAN : VERDICT_UNEXPLAINED;
        return;
    }
    const bool holds = free_run_holds(d);
    d->verdict =
        at_the_noise(d, d->extended) && !d->structure.certain && holds ? VERDICT_EXPLAINED : VERDICT_PARTLY;
    if (!holds) {
        const size_t used = strlen(d->structure.words);
        snprintf(d->structure.words + used, sizeof d->structure.words - used,
                 "%sthe model that runs freely got worse, %.3g %% to %.3g %%", used ? "; " : "",
                 d->free_nominal_percent, d->free_extended_percent);
    }
}

/* A free run that left the current behind tells nothing by its size. */
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

/* The error of the named causes with what may move unnamed beside them: effects without a name are left out. */
static double error_within_digits(const session *w)
{
    double z[P_COUNT];
    memcpy(z, w->state.z, sizeof z);
    last_digits_bound(w->state.set, z);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(w->state.set, h) && !hypothesis_cause(h)->named) {
            hypothesis_copy(h, hypothesis_nominal, z);
        }
    }
    const averaged_drive drive = session_drive(w, z);
    return measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
}

static double error_with(const diagnose_rows *r, const averaged_drive *drive)
{
    return measure_one_cycle(r, drive, MEASURE_ALL, true);
}

/* From the motor file's values on. */
static bool begin(session *w, const diagnose_teller *teller)
{
    bool turned = false;
    return fit_of_nominal(&w->fitted, &w->nominal) &&
           (!revolution_in_file(&w->fitted) ||
            revolution_align(&w->fitted, &w->nominal, w->frame.pole_pairs, &turned)) &&
           (!turned || fit_of_nominal(&w->fitted, &w->nominal)) && causes_find(w, teller);
}

/* What the rows were mended of may have hidden more: a ripple of the link hides the updates that were missed. */
static bool mend_rows(session *w, const motor *m, const diagnose_options *options)
{
    size_t mended = 1;
    for (int again = 0; mended > 0 && again < 2; again++) {
        if (!mending_by_rows(w, m, options->skip, options->teller.trace, &mended) ||
            (mended > 0 && !begin(w, &options->teller))) {
            return false;
        }
    }
    return true;
}

/* What names that did not bear out had taken up may be what rows can be mended of: beside those it did not show. */
static bool mend_what_is_left(session *w, const motor *m, const diagnose_options *options)
{
    size_t mended = 0;
    if (!mending_by_rows(w, m, options->skip, options->teller.trace, &mended)) {
        return false;
    }
    if (mended == 0) {
        return true;
    }
    w->more_left = false;
    return begin(w, &options->teller) && reconsider(w, &options->teller) &&
           causes_bear_out(w, &options->teller);
}

static bool work(session *w, diagnosis *d, const motor *m, const diagnose_options *options)
{
    hypothesis_id member[DIAGNOSIS_CAUSES] = {0};
    w->possible = hypotheses_possible(&w->rows, &w->frame) & ~options->skip;
    bool changed = false;
    w->fitted.searches = true;
    if (!begin(w, &options->teller) || !mending_by_modulator(w, options->teller.trace, &changed) ||
        (changed && !begin(w, &options->teller)) || !mend_rows(w, m, options)) {
        return false;
    }
    d->outliers = measure_glitches(&w->fitted, &w->state);
    if (d->outliers > 0) {
        /* Glitches pull on every estimate: once more without them. */
        if (options->teller.trace) {
            fprintf(options->teller.trace, "  %zu glitches left out, searched again\n", d->outliers);
        }
        if (!fit_gains(&w->fitted, &w->nominal) || !causes_find(w, &options->teller)) {
            return false;
        }
    }
    if (!reconsider(w, &options->teller) || !causes_bear_out(w, &options->teller) ||
        (w->more_left && !mend_what_is_left(w, m, options))) {
        return false;
    }
    if (options->teller.trace) {
        fprintf(options->teller.trace, "  rows predicted: %.2g\n", w->fitted.effort);
    }
    d->nominal_drive = w->frame.nominal;
    d->extended_motor = *m;
    const diagnose_rows recorded = mended_rows(&w->rows, 0);
    d->nominal = error_with(&recorded, &d->nominal_drive);
    named_tell(w, d, member);
    d->extended = error_with(&w->rows, &d->extended_drive);
    double current = measure_current(&w->rows, MEASURE_ALL, true);
    d->noise_floor =
        100.0 * measure_floor(&w->rows, &w->state, &d->extended_drive, &d->sensor_noise_A) / current;
    d->noise_floor = fmin(d->noise_floor, d->extended);
    d->within_digits = error_within_digits(w);
    d->gain = d->extended > 0.0 ? d->nominal / d->extended : 1.0;
    const double excess = (at_the_noise(d, d->extended) ? d->within_digits : d->extended) / d->noise_floor;
    if (!measure_lines(&w->fitted, &w->state, excess, &d->structure) ||
        !measure_runs(&w->rows, d, options->series)) {
        return false;
    }
    mention_decoys(w, d);
    mention_more_left(w, d);
    decide(d, w->rows.mends > 0);
    if ((d->verdict == VERDICT_PARTLY || d->verdict == VERDICT_UNEXPLAINED) && !learned_find(&w->rows, d)) {
        return false;
    }
    bound_runs(d);
    if (!tell_hypotheses(w, d, member, options->skip)) {
        return false;
    }
    mended_causes_tell(&w->rows, m, d);
    advice_tell(w, d);
    sentence_tell(d);
    d->rows_clipped = w->rows.clipped;
    for (size_t b = 0; b < w->rows.blocks; b++) {
        d->rows_used += w->rows.block[b].count;
        d->rows_held_out += w->rows.block[b].held_out ? w->rows.block[b].count : 0;
    }
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
                         "no current flows in the rows that are held out: errors are told in percent of it");
    }
    if (ok) {
        w->frame = coordinates_of(m, &w->rows);
        w->frame.of_least = options->any_size ? 0.0 : 1.0;
        ok = (mending_by_columns(w, m, options->skip, options->teller.trace) ||
              error_failure(e, 0, "out of memory for %zu rows", w->rows.rows)) &&
             fit_data_make(&w->fitted, &w->rows, &w->frame, SEARCH_ROWS, e);
    }
    if (ok && !work(w, d, m, options)) {
        ok = error_failure(e, 0, "out of memory in the diagnosis of %zu rows", rec->rows);
    }
    if (ok && !isfinite(d->nominal + d->extended + d->noise_floor)) {
        ok = error_input(e, rec->path, 0, 0,
                         "no error can be measured on the rows that are held out: with the motor file's "
                         "values the model gives no number there");
    }
    /* Causes that explain the recording are believed; otherwise the wiring is suspected before the physics.
     */
    if (ok && d->extended > SUSPECT * d->noise_floor) {
        ok = check_wiring(rec, m, d->extended > FAR_OFF, e);
    }
    ok = ok && check_motor_file(&d->extended_drive, &d->nominal_drive, rec, e);
    fit_data_free(&w->fitted);
    rows_free(&w->rows);
    free(w);
    if (!ok) {
        diagnosis_free(d);
    }
    return ok;
}

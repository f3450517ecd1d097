#include "diagnose.h"

#include "cause_report.h"
#include "certainty.h"
#include "confusion.h"
#include "diagnose_text.h"
#include "measure.h"
#include "plausible.h"
#include "search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    SEARCH_ROWS =
        24000, /* more are searched in evenly spread blocks: time, not accuracy, is what they would cost */
    GAIN_ROUNDS = 4
};

/*
 * A cause is certain when its robust chi square exceeds this per parameter, and its strongest parameter
 * stands four 95 % half widths off nought: about one false cause in ten thousand recordings if all is as
 * assumed, which leaves room for what is not.
 */
static const double CERTAIN_CHI_SQUARE = 25.0;
static const double CERTAIN_HALF_WIDTHS = 2.0;

/*
 * And in proportion: a small effect found beside a large one may be what the large one's law leaves (shares
 * of the chi square that all of them explain), and beside structure that no hypothesis explains it may be a
 * part of that (shares of what is left).
 */
static const double LEAST_SHARE = 5e-4;
static const double LEAST_SHARE_OF_REST = 0.05;
/* What dead time's law leaves near zero current looks like a voltage that is a little off, in all the ways
 * that follow. */
static const double LEAST_SHARE_BESIDE_DEAD_TIME = 4e-3;
static const hypothesis_set like_dead_time =
    HYPOTHESIS_BIT(H_RESISTANCE) | HYPOTHESIS_BIT(H_INDUCTANCE) | HYPOTHESIS_BIT(H_SALIENCY) |
    HYPOTHESIS_BIT(H_SATURATION) | HYPOTHESIS_BIT(H_FLUX) | HYPOTHESIS_BIT(H_VOLTAGE_GAIN) |
    HYPOTHESIS_BIT(H_EMF_HARMONICS) | HYPOTHESIS_BIT(H_ASYMMETRY_A) | HYPOTHESIS_BIT(H_ASYMMETRY_B) |
    HYPOTHESIS_BIT(H_ASYMMETRY_C) | HYPOTHESIS_BIT(H_ASYMMETRY) | HYPOTHESIS_BIT(H_ANGLE_DELAY);

/* Structure that takes less of the one-cycle error's power does no harm and is not reported. */
static const double STRUCTURE_SHARE = 0.05;

/* An extended error of this many noise floors raises the question whether the columns are what they say. */
static const double SUSPECT = 2.0;
/* And one of this many percent, whether the motor is the one of the file. Glitches and loose sensors stay
 * below. */
static const double FAR_OFF = 15.0;

/* The verdict's tolerance over the noise floor, as interfaces.md defines it. */
static const double FLOOR_TOLERANCE = 1.25;

typedef struct session {
    diagnose_rows rows;
    parameter_set parameters;
    fit_data fitted;
    fit_state state;
    fit_state nominal;
    certainty certainty;
    hypothesis_set possible;
} session;

static bool is_certain(const session *w, hypothesis_id h)
{
    const hypothesis *hypo = &hypothesis_table[h];
    if (hypo->fixed) {
        return true;
    }
    double strongest = 0.0;
    for (size_t k = 0; k < hypo->columns; k++) {
        double half = certainty_half_width(&w->certainty, hypo->column[k]);
        double z = w->state.z[hypo->column[k] == COLUMN_L ? P_L_D : hypo->column[k]];
        strongest = fmax(strongest, half > 0.0 ? fabs(z) / half : 0.0);
    }
    return certainty_chi_square(&w->certainty, &w->state, h) > CERTAIN_CHI_SQUARE * (double)hypo->columns &&
           strongest > CERTAIN_HALF_WIDTHS;
}

/* Adds a hypothesis' fitted values to a partial model. */
static void adopt(const session *w, hypothesis_id h, double z[P_COUNT])
{
    const hypothesis *hypo = &hypothesis_table[h];
    for (size_t k = 0; k < hypo->columns; k++) {
        if (hypo->column[k] == COLUMN_L) {
            z[P_L_D] = w->state.z[P_L_D];
            z[P_L_Q] = w->state.z[P_L_Q];
        } else {
            z[hypo->column[k]] = w->state.z[hypo->column[k]];
        }
    }
    if (h == H_DEAD_TIME) {
        z[P_KNEE] = w->state.z[P_KNEE];
        z[P_RIPPLE] = w->state.z[P_RIPPLE];
        z[P_EDGE] = w->state.z[P_EDGE];
    }
}

/* Held-out error of the model that holds the named members of a set, at the fitted values. */
static double named_error(const session *w, hypothesis_set set)
{
    double z[P_COUNT] = {0};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((set & HYPOTHESIS_BIT(h)) && hypothesis_table[h].named) {
            adopt(w, h, z);
        }
    }
    averaged_drive drive = parameters_drive(&w->parameters, z);
    return measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
}

/* What is left of the one-cycle error beyond the sensors' noise, as a share of the noise's power. */
static double rest_of(const session *w)
{
    double noise = 0.0;
    averaged_drive drive = parameters_drive(&w->parameters, w->state.z);
    double floor = measure_floor(&w->rows, &w->state, &drive, &noise);
    double wrong = 0.01 * measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true) *
                   measure_current(&w->rows, MEASURE_ALL, true);
    return floor > 0.0 ? fmax(wrong * wrong / (floor * floor) - 1.0, 0.0) : 0.0;
}

/* The member that is least worth its name, H_COUNT if all are. */
static hypothesis_id weakest(const session *w, const search_view *view)
{
    search_option own;
    search_option none;
    hypothesis_set decoys = 0;
    search_cost(view, &w->state, w->state.set, &own);
    /* A voltage that acts late is exactly that: its law leaves nothing that another cause could be taken for.
     */
    hypothesis_set exact = HYPOTHESIS_BIT(H_VOLTAGE_DELAY_1) | HYPOTHESIS_BIT(H_VOLTAGE_DELAY_2);
    search_cost(view, &w->state, w->state.set & exact, &none);
    double total = none.cost - own.cost;
    double rest = rest_of(w);
    double unexplained = rest > FLOOR_TOLERANCE * FLOOR_TOLERANCE - 1.0 ? rest * own.cost : 0.0;
    double cost_without[H_COUNT] = {0};
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (w->state.set & HYPOTHESIS_BIT(h)) {
            search_option without;
            search_cost(view, &w->state, w->state.set & ~HYPOTHESIS_BIT(h), &without);
            cost_without[h] = without.cost - own.cost;
            if (!hypothesis_table[h].named) {
                decoys |= HYPOTHESIS_BIT(h);
                unexplained += cost_without[h];
            }
        }
    }
    hypothesis_id worst = H_COUNT;
    double least = INFINITY;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        double bar = LEAST_SHARE * total;
        if ((w->state.set & HYPOTHESIS_BIT(H_DEAD_TIME)) && (like_dead_time & HYPOTHESIS_BIT(h))) {
            bar = LEAST_SHARE_BESIDE_DEAD_TIME * total;
        }
        if (!(decoys & HYPOTHESIS_BIT(h))) {
            bar = fmax(bar, LEAST_SHARE_OF_REST * unexplained);
        }
        bool in = (w->state.set & HYPOTHESIS_BIT(h)) != 0;
        /* Beside an effect without a name a cause must also help where it stands alone with the other causes.
         */
        bool harms =
            in && decoys && hypothesis_table[h].named &&
            named_error(w, w->state.set & ~HYPOTHESIS_BIT(h)) <= 1.005 * named_error(w, w->state.set);
        if (in && (!is_certain(w, h) || harms || cost_without[h] < bar) && cost_without[h] < least) {
            least = cost_without[h];
            worst = h;
        }
    }
    return worst;
}

/* Takes a hypothesis out of a state: its parameters go back to the motor file's. */
static void leave(fit_state *s, hypothesis_id h)
{
    s->set &= ~HYPOTHESIS_BIT(h);
    for (size_t k = 0; k < hypothesis_table[h].columns; k++) {
        if (hypothesis_table[h].column[k] == COLUMN_L) {
            s->z[P_L_D] = s->z[P_L_Q] = 0.0;
        } else {
            s->z[hypothesis_table[h].column[k]] = 0.0;
        }
    }
}

/* Starts over from the motor file with the hypotheses allowed, and drops what is not certain until all that
 * stays is. */
static bool find_causes(session *w, FILE *trace)
{
    hypothesis_set allowed = w->possible;
    search_view *view = calloc(1, sizeof *view);
    w->state = w->nominal;
    bool ok = view != NULL;
    while (ok) {
        fit_noise(&w->fitted, &w->state);
        ok = search_best(&w->fitted, &w->state, allowed, trace) && fit_refine(&w->fitted, &w->state, 12) &&
             certainty_of(&w->fitted, &w->state, &w->certainty) && search_look(&w->fitted, &w->state, view);
        hypothesis_id worst = ok ? weakest(w, view) : H_COUNT;
        if (worst == H_COUNT) {
            break;
        }
        if (trace) {
            fprintf(trace, "  not certain, or too small a part: %s\n", hypothesis_table[worst].words);
        }
        allowed &= ~HYPOTHESIS_BIT(worst);
        leave(&w->state, worst);
    }
    free(view);
    return ok;
}

/* The causes in the order of what each takes off the held-out error, with their gains. Fills `member`
 * likewise. */
static void order_causes(session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES])
{
    double z[P_COUNT] = {0};
    double before = d->nominal;
    hypothesis_set left = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        left |= hypothesis_table[h].named ? w->state.set & HYPOTHESIS_BIT(h) : 0;
    }
    while (left && d->causes < DIAGNOSIS_CAUSES) {
        double best = INFINITY;
        hypothesis_id chosen = H_COUNT;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            if (left & HYPOTHESIS_BIT(h)) {
                double trial[P_COUNT];
                memcpy(trial, z, sizeof trial);
                adopt(w, h, trial);
                averaged_drive drive = parameters_drive(&w->parameters, trial);
                double after = measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
                if (after < best) {
                    best = after;
                    chosen = h;
                }
            }
        }
        diagnosis_cause *cause = &d->cause[d->causes];
        cause_report(cause, chosen, &w->fitted, &w->state, &w->certainty);
        cause->certainty = certainty_chi_square(&w->certainty, &w->state, chosen);
        cause->gain = best > 0.0 ? before / best : 1.0;
        member[d->causes++] = chosen;
        adopt(w, chosen, z);
        before = best;
        left &= ~HYPOTHESIS_BIT(chosen);
    }
    /* The extended model holds what was named and nothing else; it is written with the firmware's plain law
     * of dead time. */
    z[P_OFFSET_ZERO] = w->state.z[P_OFFSET_ZERO];
    d->extended_drive = parameters_drive(&w->parameters, z);
    averaged_drive plain = d->extended_drive;
    if (z[P_V_DEAD] != 0.0) {
        plain.i_knee_A = cause_plain_knee_A(&plain, &w->rows, w->parameters.i_rated_peak_A);
    }
    d->extended_motor = averaged_drive_motor(&plain, &d->extended_motor);
}

/* A decoy that was chosen is structure, known to be there but without a name in the list of causes, if it
 * matters. */
static void mention_decoys(const session *w, diagnosis *d)
{
    averaged_drive all = parameters_drive(&w->parameters, w->state.z);
    double best = measure_one_cycle(&w->rows, &all, MEASURE_ALL, true);
    double share = 1.0 - best * best / (d->extended * d->extended);
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if ((w->state.set & HYPOTHESIS_BIT(h)) && !hypothesis_table[h].named && share > STRUCTURE_SHARE) {
            size_t used = strlen(d->structure.words);
            d->structure.certain = true;
            snprintf(d->structure.words + used, sizeof d->structure.words - used, "%sit looks like %s",
                     used ? "; " : "", hypothesis_table[h].words);
        }
    }
}

static bool tabulate_hypotheses(session *w, diagnosis *d, const hypothesis_id *member, hypothesis_set skipped)
{
    search_view *view = calloc(1, sizeof *view);
    if (!view || !search_look(&w->fitted, &w->state, view)) {
        free(view);
        return false;
    }
    confusion_find(d, view, &w->state, member, w->possible, w->certainty.inflation);
    search_option own;
    search_option none;
    search_cost(view, &w->state, w->state.set, &own);
    search_cost(view, &w->state, 0, &none);
    for (hypothesis_id h = 0; h < H_COUNT && d->hypotheses < sizeof d->hypothesis / sizeof *d->hypothesis;
         h++) {
        diagnosis_hypothesis *row = &d->hypothesis[d->hypotheses++];
        search_option alone;
        search_option more;
        *row =
            (diagnosis_hypothesis){.id = hypothesis_table[h].cause,
                                   .words = hypothesis_table[h].words,
                                   .named = (w->state.set & HYPOTHESIS_BIT(h)) && hypothesis_table[h].named,
                                   .possible = (w->possible & HYPOTHESIS_BIT(h)) != 0,
                                   .skipped = (skipped & HYPOTHESIS_BIT(h)) != 0};
        search_cost(view, &w->state, HYPOTHESIS_BIT(h), &alone);
        if (none.cost > own.cost) {
            row->alone = fmin(fmax((none.cost - alone.cost) / (none.cost - own.cost), 0.0), 1.0);
        }
        if (hypothesis_joins(w->state.set, h)) {
            search_cost(view, &w->state, w->state.set | HYPOTHESIS_BIT(h), &more);
            row->beyond = fmax(own.cost - more.cost, 0.0);
        }
    }
    free(view);
    return true;
}

static void decide(diagnosis *d)
{
    double tolerance = FLOOR_TOLERANCE * d->noise_floor;
    if (d->causes == 0) {
        d->verdict = d->nominal <= tolerance && !d->structure.certain ? VERDICT_CLEAN : VERDICT_UNEXPLAINED;
    } else {
        d->verdict = d->extended <= tolerance && !d->structure.certain ? VERDICT_EXPLAINED : VERDICT_PARTLY;
    }
    d->gain = d->extended > 0.0 ? d->nominal / d->extended : 1.0;
}

static bool work(session *w, diagnosis *d, const motor *m, const diagnose_options *options)
{
    hypothesis_id member[DIAGNOSIS_CAUSES] = {0};
    w->possible = hypotheses_possible(&w->rows, &w->parameters) & ~options->skip;
    w->nominal = fit_nominal();
    fit_noise(&w->fitted, &w->nominal);
    for (int k = 0; k < GAIN_ROUNDS; k++) {
        fit_gain(&w->fitted, &w->nominal);
    }
    if (!find_causes(w, options->trace)) {
        return false;
    }
    d->outliers = measure_outliers(&w->fitted, &w->state);
    if (d->outliers > 0) {
        /* Glitches pull on every estimate: once more without them. */
        if (options->trace) {
            fprintf(options->trace, "  %zu glitches left out, searched again\n", d->outliers);
        }
        fit_gain(&w->fitted, &w->nominal);
        if (!find_causes(w, options->trace)) {
            return false;
        }
    }
    d->nominal_drive = w->parameters.nominal;
    d->extended_motor = *m;
    d->nominal = measure_one_cycle(&w->rows, &d->nominal_drive, MEASURE_ALL, true);
    order_causes(w, d, member);
    d->extended = measure_one_cycle(&w->rows, &d->extended_drive, MEASURE_ALL, true);
    double current = measure_current(&w->rows, MEASURE_ALL, true);
    d->noise_floor =
        100.0 * measure_floor(&w->rows, &w->state, &d->extended_drive, &d->sensor_noise_A) / current;
    if (!measure_structure(&w->fitted, &w->state, d->extended / d->noise_floor, &d->structure)) {
        return false;
    }
    mention_decoys(w, d);
    decide(d);
    if (!tabulate_hypotheses(w, d, member, options->skip)) {
        return false;
    }
    confusion_advise(d, &w->rows);
    diagnose_sentence(d);
    for (size_t b = 0; b < w->rows.blocks; b++) {
        d->rows_used += w->rows.block[b].count;
        d->rows_held_out += w->rows.block[b].held_out ? w->rows.block[b].count : 0;
    }
    return measure_runs(&w->rows, &w->state, d, options->series);
}

bool diagnose(diagnosis *d, const recording *rec, const char *recording_path, const motor *m,
              const diagnose_options *options, error *e)
{
    memset(d, 0, sizeof *d);
    d->rows = rec->rows;
    session *w = calloc(1, sizeof *w);
    if (!w) {
        return error_failure(e, 0, "out of memory");
    }
    bool ok = plausible_columns(rec, recording_path, m, e) && rows_prepare(&w->rows, rec, m, e);
    if (ok) {
        w->parameters = parameters_of(m, &w->rows);
        ok = fit_data_make(&w->fitted, &w->rows, &w->parameters, SEARCH_ROWS, false, e);
    }
    if (ok && !work(w, d, m, options)) {
        ok = error_failure(e, 0, "out of memory in the diagnosis of %zu rows", rec->rows);
    }
    /* Causes that explain the recording are believed; otherwise the wiring is suspected before the physics.
     */
    if (ok && d->extended > SUSPECT * d->noise_floor) {
        ok = plausible_wiring(rec, m, d->extended > FAR_OFF, recording_path, e);
    }
    ok = ok && plausible_motor(&d->extended_drive, &d->nominal_drive, recording_path, e);
    fit_data_free(&w->fitted);
    rows_free(&w->rows);
    free(w);
    if (!ok) {
        diagnosis_free(d);
    }
    return ok;
}

void diagnosis_free(diagnosis *d)
{
    free(d->error_nominal);
    free(d->error_extended);
    free(d->free_nominal);
    free(d->free_extended);
    free(d->held_out);
    memset(d, 0, sizeof *d);
}

const char *diagnosis_verdict_id(diagnosis_verdict v)
{
    static const char *const id[] = {"clean", "explained", "partly", "unexplained"};
    return id[v];
}

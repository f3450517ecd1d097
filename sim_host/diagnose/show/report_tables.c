/* The report's words and tables (report_tables.h). */
#include "report_tables.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *unit_of(const diagnosis_parameter *p)
{
    return strcmp(p->unit, "1") == 0 ? "" : p->unit;
}

void report_lead(page *p, const diagnosis *d)
{
    page_lead(p, "%s", d->sentence);
    if (d->causes == 0 && d->structure.words[0] != '\0') {
        page_text(p, "What is seen: %s.", d->structure.words);
    }
}

/* "a, b", or `none`. */
static void list_cell(page *p, const char *const *item, size_t count, const char *between, const char *none)
{
    char text[256] = "";
    for (size_t n = 0; n < count; n++) {
        const size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "%s%s", n > 0 ? between : "", item[n]);
    }
    page_cell(p, false, "%s", count > 0 ? text : none);
}

static void interval_cell(page *p, double low, double high)
{
    if (high > low) {
        page_cell(p, true, "%.5g ... %.5g", low, high);
    } else {
        page_cell(p, true, " ");
    }
}

static void cause_rows(page *p, const diagnosis_cause *cause)
{
    for (size_t n = 0; n < cause->parameters; n++) {
        const diagnosis_parameter *q = &cause->parameter[n];
        page_row_begin(p);
        page_cell(p, false, "%s", n == 0 ? cause->id : "");
        page_cell(p, false, "%s%s%s", q->name, unit_of(q)[0] ? ", " : "", unit_of(q));
        page_cell(p, true, "%.5g", q->value);
        interval_cell(p, q->low, q->high);
        page_cell(p, true, "%.5g", q->nominal);
        if (n == 0) {
            page_cell(p, true, "%.2f", cause->gain);
            page_cell(p, true, "%.3g", cause->probability);
            list_cell(p, cause->confused_with, cause->confused, ", ", "nothing");
            list_cell(p, cause->trade, cause->trades, " + ", "nothing");
        }
        for (int empty = 0; n > 0 && empty < 4; empty++) {
            page_cell(p, false, " ");
        }
        page_row_end(p);
    }
}

void report_causes(page *p, const diagnosis *d)
{
    static const char *const heads[] = {"cause",         "parameter",     "\tvalue",
                                        "\t95 %",        "\tfile says",   "\tgain",
                                        "\tprobability", "confused with", "trades with"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < d->causes; k++) {
        cause_rows(p, &d->cause[k]);
    }
    page_table_end(p);
    page_note(
        p,
        "Gain: one-cycle error before the cause was added over the error after, causes in this order, rows "
        "that "
        "were not fitted. Probability: its share of the evidence of all sets of causes about the one chosen. "
        "Confused with: what this recording cannot tell from it. Trades with: what together would do exactly "
        "the "
        "same; the fewer causes win. What the causes are: the glossary below.");
}

void report_estimates(page *p, const diagnosis *d)
{
    static const char *const heads[] = {"parameter", "\tvalue", "\t95 %", "unit", ""};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        const diagnosis_estimate *q = &d->estimate[k];
        page_row_begin(p);
        page_cell(p, false, "%s", q->name);
        if (q->excited) {
            page_cell(p, true, "%.5g", q->value);
            interval_cell(p, q->low, q->high);
        } else {
            page_cell(p, true, " ");
            page_cell(p, true, " ");
        }
        page_cell(p, false, "%s", strcmp(q->unit, "1") == 0 ? "" : q->unit);
        page_cell(p, false, "%s", q->excited ? "" : "the recording does not show it");
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p, "What the recording says of these whether a cause was named for them or not; voltage_delay "
                 "in cycles.");
}

static void error_row(page *p, const char *what, double nominal, double extended, double floor, double gain)
{
    page_row_begin(p);
    page_cell(p, false, "%s", what);
    page_cell(p, true, "%.3f", nominal);
    page_cell(p, true, "%.3f", extended);
    if (isfinite(floor)) {
        page_cell(p, true, "%.3f", floor);
    } else {
        page_cell(p, true, " ");
    }
    page_cell(p, true, "%.2f", gain);
    page_row_end(p);
}

void report_errors(page *p, const diagnosis *d, const firmware_gain *firmware)
{
    static const char *const heads[] = {"one-cycle error, %", "\tas it was", "\textended", "\tnoise alone",
                                        "\tgain"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    error_row(p, "exact model, double", d->nominal, d->extended, d->noise_floor, d->gain);
    if (firmware->measured) {
        error_row(p, "firmware, IQ24", firmware->nominal, firmware->extended, NAN, firmware->gain);
    }
    page_table_end(p);
    page_note(p,
              "%zu rows held out of %zu used; the error vector's rms over the current vector's. Sensor "
              "noise, as estimated from this "
              "recording: %.3g A rms per phase.%s",
              d->rows_held_out, d->rows_used, d->sensor_noise_A,
              d->outliers > 0 ? " Glitches were left out of the fit." : "");
    for (int id = 0; id < CAUSE_COUNT; id++) {
        if (d->extended_motor.ext.has[id] && cause_table[id].firmware == FIRMWARE_LACKS) {
            page_note(p, "The firmware has no correction for %s: in its row that effect stays.",
                      cause_table[id].id);
        }
    }
    if (!firmware->measured) {
        page_note(p, "Not measured in firmware code: %s.", firmware->reason);
    }
    if (d->structure.words[0] != '\0' && d->causes > 0) {
        page_text(p, "Left over: %s.", d->structure.words);
    }
}

void report_learned(page *p, const diagnosis *d)
{
    static const char *const heads[] = {"term", "\tvalue", "unit"};
    const diagnosis_learned *l = &d->learned;
    page_text(p,
              "Learned, not named: %s. With these terms the one-cycle error of the rows that were not fitted "
              "falls from %.3g %% to %.3g %% (gain %.2f). They say where to look, not what it is.",
              l->words, l->nominal, l->extended, l->gain);
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < l->terms; k++) {
        page_row_begin(p);
        page_cell(p, false, "%s", l->term[k].name);
        page_cell(p, true, "%.5g", l->term[k].value);
        page_cell(p, false, "%s", l->term[k].unit);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(
        p, "The voltage along d or q that the model lacks is the sum of the value times the term; omega in "
           "electrical rad/s, currents in A, angles of the rotor.");
}

void report_hypotheses(page *p, const diagnosis *d)
{
    static const char *const heads[] = {"hypothesis", "what it is", "\talone explains", "\twould add", ""};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < d->hypotheses; k++) {
        const diagnosis_hypothesis *h = &d->hypothesis[k];
        page_row_begin(p);
        page_cell(p, false, "%s", h->id);
        page_cell(p, false, "%s", strcmp(h->id, h->words) == 0 ? "" : h->words);
        if (h->possible && d->causes > 0) {
            page_cell(p, true, "%.0f %%", 100.0 * h->alone);
        } else {
            page_cell(p, true, " ");
        }
        if (h->possible && !h->named) {
            page_cell(p, true, "%.3g", h->beyond);
        } else {
            page_cell(p, true, " ");
        }
        page_cell(p, false, "%s",
                  h->named
                      ? "named"
                      : (h->skipped ? "left out by request" : (h->possible ? "" : "cannot be seen here")));
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p, "Alone: share of what all named causes together explain (in likelihood) that this one would "
                 "explain by itself. "
                 "Would add: chi square that it would still take off the extended model, linearised there. "
                 "What is not named is not "
                 "certain, or too small beside the named to be more than what their laws leave.");
}

/* Rounded, and no minus sign at nought. */
static double rounded(double x, double step)
{
    return step * nearbyint(x / step) + 0.0;
}

/* A run none of whose rows was held out has no such error. */
static void error_cell(page *p, double percent)
{
    if (isfinite(percent) && percent > 0.0) {
        page_cell(p, true, "%.3f", percent);
    } else {
        page_cell(p, true, " ");
    }
}

/* None where the free run lost the current. */
static void free_run_cell(page *p, double percent)
{
    if (isfinite(percent)) {
        page_cell(p, true, "%.2f", percent);
    } else {
        page_cell(p, true, "-");
    }
}

void report_runs(page *p, const diagnosis *d, const plant_witness *witness)
{
    static const char *const heads[] = {"\trun",          "\trad/s",       "\tA rms",       "\ti_d, A",
                                        "\ti_q, A",       "\tas it was",   "\textended",    "\tnoise alone",
                                        "\tfree run was", "\tfree run is", "\ton the plant"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0] - (witness->simulated ? 0 : 1));
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *run = &d->run[k];
        page_row_begin(p);
        page_cell(p, true, "%ld", run->run);
        page_cell(p, true, "%.1f", rounded(run->omega_rad_s, 0.1));
        page_cell(p, true, "%.2f", run->i_rms_A);
        page_cell(p, true, "%.2f", rounded(run->i_d_A, 0.01));
        page_cell(p, true, "%.2f", rounded(run->i_q_A, 0.01));
        error_cell(p, run->nominal);
        error_cell(p, run->extended);
        error_cell(p, run->noise_floor);
        free_run_cell(p, run->free_nominal);
        free_run_cell(p, run->free_extended);
        if (witness->simulated) {
            const diagnosis_run *simulated = plant_witness_run(witness, d, k);
            error_cell(p, simulated != NULL ? simulated->nominal : 0.0);
        }
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p, "Errors in percent of the run's current. Currents d and q are means over the run, so that "
                 "steps of both signs cancel.");
}

void report_plant(page *p, const diagnosis *d, const plant_witness *witness)
{
    if (!witness->simulated) {
        page_text(p, "Not simulated: %s.", witness->reason);
        return;
    }
    char named[256] = "";
    for (size_t k = 0; k < witness->found.causes; k++) {
        const size_t used = strlen(named);
        snprintf(named + used, sizeof named - used, "%s%s", k > 0 ? ", " : "", witness->found.cause[k].id);
    }
    page_text(p,
              "The drive at switching level, with %s, was driven by the firmware's code through the %zu "
              "operating points of the recording. On "
              "it the model as it was errs by %.3g %% (on the machine: %.3g %%). Beyond the noise, run by "
              "run, that is %.0f %% of the machine's. "
              "Diagnosed with the same motor file, the plant's recording shows: %s.",
              witness->effect, witness->found.runs, witness->found.nominal, d->nominal, 100.0 * witness->size,
              witness->found.causes > 0 ? named : "no cause");
}

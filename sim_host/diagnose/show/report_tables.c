/* The report's tables (report_tables.h). */
#include "report_tables.h"

#include "base/number.h"
#include "diagnose/tell/dead_time.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *unit_of(const diagnosis_parameter *p)
{
    return strcmp(p->unit, "1") == 0 ? "" : p->unit;
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
    char probability[NUMBER_TEXT_SIZE];
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
            page_cell(p, true, "%s", number_or_dash(cause->probability, 3, probability));
            list_cell(p, cause->confused_with, cause->confused, ", ", "none");
            list_cell(p, cause->trade, cause->trades, " + ", "none");
        }
        for (int empty = 0; n > 0 && empty < 4; empty++) {
            page_cell(p, false, " ");
        }
        page_row_end(p);
    }
}

void report_causes(page *p, const diagnosis *d)
{
    static const char *const heads[] = {
        "cause",        "parameter",         "\tvalue",       "\t95 %",
        "\tmotor file", "\terror reduction", "\tprobability", "not distinguishable from",
        "equivalent to"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t k = 0; k < d->causes; k++) {
        cause_rows(p, &d->cause[k]);
    }
    page_table_end(p);
    page_note(
        p,
        "Error reduction: one-cycle error before the cause was added, divided by the error after it, on "
        "held-out rows, causes in this order. Probability: the cause's share of the evidence among all sets "
        "of causes near the chosen set, times the probability that the effect is in the catalogue. Not "
        "distinguishable from: this recording cannot separate the two. "
        "Equivalent to: these causes together have exactly the same effect, and the smaller set is chosen.");
    for (size_t k = 0; k < d->causes; k++) {
        const diagnosis_parameter *dead = dead_time_of(&d->cause[k]);
        if (dead != NULL) {
            char time[64];
            dead_time_words(&d->extended_motor, dead->value, time, sizeof time);
            page_note(p,
                      "v_dead is %.3g V, or %s (v_dead = u_dc t_dead f_pwm, constant device drops included).",
                      dead->value, time);
        }
    }
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
        page_cell(p, false, "%s", q->excited ? "" : "not excited by this recording");
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p,
              "Estimates of this recording, whether a cause was named for them or not. voltage_delay is in "
              "control cycles.");
}

/* Empty if it is not known. */
static void number_cell(page *p, int digits, double value)
{
    if (isfinite(value)) {
        page_cell(p, true, "%.*f", digits, value);
    } else {
        page_cell(p, true, " ");
    }
}

static void error_row(page *p, const char *what, double nominal, double extended, double floor, double gain)
{
    page_row_begin(p);
    page_cell(p, false, "%s", what);
    number_cell(p, 3, nominal);
    number_cell(p, 3, extended);
    number_cell(p, 3, floor);
    number_cell(p, 2, gain);
    page_row_end(p);
}

void report_errors(page *p, const diagnosis *d, const firmware_gain *firmware)
{
    static const char *const heads[] = {"one-cycle error, %", "\tnominal model", "\textended model",
                                        "\tnoise floor", "\terror reduction"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    error_row(p, "exact model, double", d->nominal, d->extended, d->noise_floor, d->gain);
    if (firmware->measured) {
        error_row(p, "firmware, IQ24", firmware->nominal, firmware->extended, NAN, firmware->gain);
    }
    page_table_end(p);
    page_note(
        p,
        "Rms of the error vector divided by rms of the current vector, on %zu held-out rows of %zu. Sensor "
        "noise, estimated from this recording: %.3g A rms per phase.%s",
        d->rows_held_out, d->rows_used, d->sensor_noise_A,
        d->outliers > 0 ? " The fit ignores glitches." : "");
    for (int id = 0; id < CAUSE_COUNT; id++) {
        if (motor_has_first(&d->extended_motor, (cause_id)id) &&
            firmware_correction(&firmware->map, (cause_id)id) == FIRMWARE_LACKS) {
            page_note(p, "The firmware has no correction for %s: its row keeps that error.",
                      cause_table[id].id);
        }
    }
    if (firmware->map.fitted && firmware->map.there) {
        page_note(p,
                  "The firmware holds the flux map as parts that saturate. Their flux is %.2g %% off that of "
                  "the map over the recorded currents, rms.",
                  100.0 * firmware->map.off);
    }
    if (isnan(firmware->gain)) {
        page_note(p, "The firmware's error reduction is not known: %s.", firmware->reason);
    }
}

void report_learned(page *p, const diagnosis *d)
{
    static const char *const heads[] = {"term", "\tvalue", "unit"};
    const diagnosis_learned *l = &d->learned;
    page_text(
        p,
        "Fitted terms without a named cause: %s. They reduce the held-out one-cycle error from %.3g %% to "
        "%.3g %% (factor %.2f). They show where to look; they name no cause.",
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
    page_note(p, "The residual voltage in d or q is the sum of value times term. omega in electrical rad/s, "
                 "currents in "
                 "A, rotor angles.");
}

/* Rounded, and never -0. */
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

/* A dash if the open-loop simulation diverged. */
static void open_loop_cell(page *p, double percent)
{
    if (isfinite(percent)) {
        page_cell(p, true, "%.2f", percent);
    } else {
        page_cell(p, true, "-");
    }
}

void report_runs(page *p, const diagnosis *d, const forward_validation *validation)
{
    static const char *const heads[] = {"\trun",
                                        "\trad/s",
                                        "\tA rms",
                                        "\ti_d, A",
                                        "\ti_q, A",
                                        "\tnominal",
                                        "\textended",
                                        "\tnoise floor",
                                        "\topen loop, nominal",
                                        "\topen loop, extended",
                                        "\tnominal, simulated drive"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0] - (validation->simulated ? 0 : 1));
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
        open_loop_cell(p, run->free_nominal);
        open_loop_cell(p, run->free_extended);
        if (validation->simulated) {
            const diagnosis_run *simulated = forward_validation_run(validation, d, k);
            error_cell(p, simulated != NULL ? simulated->nominal : 0.0);
        }
        page_row_end(p);
    }
    page_table_end(p);
    page_note(
        p, "Errors in percent of the run's rms current: one cycle, and open-loop simulation over each whole "
           "stretch. i_d and i_q are means over the run; steps of both signs cancel.");
}

void report_plant(page *p, const diagnosis *d, const forward_validation *validation)
{
    if (!validation->simulated) {
        page_text(p, "No simulation: %s.", validation->reason);
        return;
    }
    char named[256] = "";
    for (size_t k = 0; k < validation->found.causes; k++) {
        const size_t used = strlen(named);
        snprintf(named + used, sizeof named - used, "%s%s", k > 0 ? ", " : "", validation->found.cause[k].id);
    }
    char size[128] = ""; /* no operating point may have an error beyond its noise */
    if (isfinite(validation->size)) {
        snprintf(size, sizeof size,
                 "Without noise, run by run, the simulated error is %.0f %% of the recorded one. ",
                 100.0 * validation->size);
    }
    page_text(
        p,
        "A switching-level simulation of the drive with %s ran the firmware code through the %zu operating "
        "points of the recording. The nominal model's error is %.3g %% on the simulated drive and %.3g %% on "
        "the recorded one. %sDiagnosis of the simulated recording with the same motor file: %s.",
        validation->effect, validation->found.runs, validation->found.nominal, d->nominal, size,
        validation->found.causes > 0 ? named : "no cause");
}

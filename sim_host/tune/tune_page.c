/* A design as a report page (tune_report.h). */
#include "tune_observer_page.h"
#include "tune_speed_page.h"

#include "base/number.h"
#include "base/vector.h"
#include "report/page.h"

#include <math.h>

/*
 * One colour has one meaning on the page: blue the nominal machine, orange the worst of the uncertainty set, green
 * tuned PI, purple tuned deadbeat, grey a requirement, a set-point or the untuned PI.
 */
#define NOMINAL_COLOUR  CHART_BLUE
#define WORST_COLOUR    CHART_ORANGE
#define PI_COLOUR       CHART_GREEN
#define DEADBEAT_COLOUR CHART_PURPLE

static chart_series line(const char *label, const chart_data *d, size_t column, chart_colour colour)
{
    return (chart_series){label, d, column, colour, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false};
}

static chart_series limit(const char *label, const chart_data *d, size_t column)
{
    return (chart_series){label, d, column, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 1.5, true};
}

/* From 0 to a little above the largest value of some columns. */
static chart_axis from_zero(const chart_data *d, size_t first, size_t last)
{
    chart_axis axis = {.fixed = true, .low = 0.0, .high = 0.0};
    for (size_t row = 0; row < d->rows; row++) {
        for (size_t n = first; n <= last; n++) {
            axis.high = fmax(axis.high, 1.1 * d->value[row * d->columns + n]);
        }
    }
    return axis;
}

/* ---- Margins over speed ---- */

/* The gain that a disk margin guarantees upwards and downwards, in dB, and the phase, in degrees. */
static double guaranteed_gain_dB(double disk)
{
    return 20.0 * log10((2.0 + disk) / (2.0 - disk));
}

static double guaranteed_phase_deg(double disk)
{
    return 360.0 / VEC_PI * atan(0.5 * disk);
}

static bool margins_figure(page *p, const tune_result *r, error *e)
{
    enum { PANELS = 4, COLUMNS = 3 };
    static const char *const titles[PANELS] = {"disk margin", "gain margin, dB", "phase margin, degrees",
                                               "delay margin, cycles"};
    static const char *const needed[PANELS] = {"required", "guaranteed by the disk margin",
                                               "guaranteed by the disk margin", "end of the search"};
    const double level[PANELS] = {r->disk_wanted, guaranteed_gain_dB(r->disk_wanted),
                                  guaranteed_phase_deg(r->disk_wanted), TUNE_DELAY_MOST};
    chart_data d = chart_data_of(1 + COLUMNS * PANELS);
    chart drawn[PANELS];
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        const tune_at_speed *at = &r->at[s];
        chart_data_add(&d,
                       (double[]){at->rpm, at->nominal.disk, at->worst.disk, level[0], at->nominal.gain_dB,
                                  at->worst.gain_dB, level[1], at->nominal.phase_deg, at->worst.phase_deg,
                                  level[2], at->nominal.delay_cycles, at->worst.delay_cycles, level[3]});
    }
    for (size_t n = 0; n < PANELS; n++) {
        const size_t first = 1 + COLUMNS * n;
        drawn[n] = (chart){.title = titles[n],
                           .x_label = "speed, rpm",
                           .x = {.fixed = true, .low = 0.0, .high = r->motor.n_max_rpm},
                           .y = from_zero(&d, first, first + 2),
                           .series = {line("nominal machine", &d, first, NOMINAL_COLOUR),
                                      line("worst of the uncertainty set", &d, first + 1, WORST_COLOUR),
                                      limit(needed[n], &d, first + 2)}};
    }
    char caption[400];
    (void)snprintf(
        caption, sizeof caption,
        "Errors of the voltage's gain, angle and delay at which the loop becomes unstable, over the "
        "speed. The disk margin is required to be %g. That guarantees a gain margin of %.1f dB and a "
        "phase margin of %.0f degrees. The search for the delay ends at one cycle.",
        r->disk_wanted, level[1], level[2]);
    const bool ok = page_charts(p, drawn, PANELS, "tune-margins", caption, e);
    chart_data_free(&d);
    return ok;
}

static void margins_table(page *p, const tune_result *r)
{
    static const char *const heads[] = {
        "\trpm",        "\tSFFR",          "\tdisk margin",  "\tgain, dB",
        "\tphase, deg", "\tdelay, cycles", "\tlargest pole", "worst disk margin with"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int s = 0; s < TUNE_SPEEDS; s += 2) {
        const tune_at_speed *at = &r->at[s];
        char sffr[NUMBER_TEXT_SIZE];
        page_row_begin(p);
        page_cell(p, true, "%.0f", at->rpm);
        page_cell(p, true, "%s", number_or_dash(at->sffr, 3, sffr));
        page_cell(p, true, "%.3f", at->worst.disk);
        page_cell(p, true, "%.2f", at->worst.gain_dB);
        page_cell(p, true, "%.1f", at->worst.phase_deg);
        page_cell(p, true, "%.2f", at->worst.delay_cycles);
        page_cell(p, true, "%.4f", at->radius_worst);
        page_cell(p, false, "%s", r->region.point[at->disk_worst].text);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(
        p, "Each margin is the smallest over the uncertainty set; different margins may come from different "
           "machines. The largest pole is that of the valley offset's estimate, over twenty cycles.");
}

/* ---- Sensitivity ---- */

enum { FREQUENCIES = 120 };

static chart_data sensitivity_of(const tune_result *r, const tune_at_speed *at)
{
    chart_data d = chart_data_of(4);
    tune_loop nominal;
    tune_loop worst;
    tune_loop_make(&r->design, &r->region.point[0].machine, at->phi_rad, &tune_no_fault, &nominal);
    tune_loop_make(&r->design, &r->region.point[at->disk_worst].machine, at->phi_rad, &tune_no_fault, &worst);
    for (int k = 0; k < FREQUENCIES; k++) {
        const double w = VEC_PI * pow(10.0, 2.0 * ((double)(k + 1) / FREQUENCIES - 1.0));
        chart_data_add(&d, (double[]){w * r->motor.f_pwm_Hz / VEC_TWO_PI, tune_sensitivity(&nominal, w),
                                      tune_sensitivity(&worst, w), 1.0});
    }
    return d;
}

static bool sensitivity_figure(page *p, const tune_result *r, error *e)
{
    enum { PANELS = 3 };
    static const int speeds[PANELS] = {0, (TUNE_SPEEDS - 1) / 2, TUNE_SPEEDS - 1};
    chart_data d[PANELS];
    char title[PANELS][48];
    chart drawn[PANELS];
    double high = 0.0;
    for (size_t n = 0; n < PANELS; n++) {
        d[n] = sensitivity_of(r, &r->at[speeds[n]]);
        high = fmax(high, from_zero(&d[n], 1, 3).high);
    }
    for (size_t n = 0; n < PANELS; n++) {
        (void)snprintf(title[n], sizeof title[n], "%.0f rpm", r->at[speeds[n]].rpm);
        drawn[n] = (chart){.title = title[n],
                           .x_label = "frequency in the rotor frame, Hz",
                           .y_label = "sensitivity",
                           .x = {.logarithmic = true},
                           .y = {.fixed = true, .low = 0.0, .high = high},
                           .series = {line("nominal machine", &d[n], 1, NOMINAL_COLOUR),
                                      line("worst of the uncertainty set", &d[n], 2, WORST_COLOUR),
                                      limit("no effect of the loop", &d[n], 3)}};
        drawn[n].series[0].mark = drawn[n].series[1].mark = CHART_LINE;
    }
    const bool ok =
        page_charts(p, drawn, PANELS, "tune-sensitivity",
                    "Sensitivity of the voltage to a disturbance, largest singular value. Below 1 the loop "
                    "reduces the disturbance, above 1 it amplifies it.",
                    e);
    for (size_t n = 0; n < PANELS; n++) {
        chart_data_free(&d[n]);
    }
    return ok;
}

/* ---- Steps and comparison ---- */

/* Where the grey curve ends, and why, for each ratio that is shown. */
static void steps_caption(const tune_comparison *c, char *caption, size_t size)
{
    size_t used = (size_t)snprintf(caption, size,
                                   "Step of i_q from 0.3 to 0.7 of the rated peak, nominal machine: the true "
                                   "mean of each cycle, firmware in IQ24 with the switching-level plant.");
    const loop_result *grey = &c->at[0][0][0];
    if (c->held[0] && grey->outcome != LOOP_TRIPS && used < size) {
        (void)snprintf(
            caption + used, size - used,
            " PI with the mid-point sample settles %.1f %% of rated away from the set-point at SFFR %g. "
            "It controls that sample, and the mean of a cycle differs from it. The difference falls "
            "with the square of the SFFR.",
            grey->offset_percent, tune_ratios[0]);
    }
}

static bool steps_figure(page *p, const tune_report *t, error *e)
{
    enum { PANELS = 4 };
    static const int drawn_ratios[PANELS] = {0, 2, 3, 4}; /* ratios 5, 10, 20, 50 */
    const tune_comparison *c = &t->comparison;
    chart_data d[PANELS];
    char title[PANELS][48];
    chart drawn[PANELS];
    for (size_t n = 0; n < PANELS; n++) {
        const int ratio = drawn_ratios[n];
        d[n] = chart_data_of(2 + TUNE_CONTROLLERS);
        for (int k = 0; k < LOOP_TRACE_CYCLES - 12 && c->held[ratio]; k++) {
            double row[2 + TUNE_CONTROLLERS] = {k - LOOP_TRACE_BEFORE};
            for (int how = 0; how < TUNE_CONTROLLERS; how++) {
                row[1 + how] = c->at[ratio][how][0].trace_q[k];
            }
            row[1 + TUNE_CONTROLLERS] = k < LOOP_TRACE_BEFORE ? 0.3 : 0.7;
            chart_data_add(&d[n], row);
        }
        (void)snprintf(title[n], sizeof title[n], c->held[ratio] ? "SFFR %g" : "SFFR %g: no design",
                       tune_ratios[ratio]);
        drawn[n] = (chart){.title = title[n],
                           .x_label = "cycles after the step",
                           .y_label = "i_q over the rated peak",
                           .x = {.fixed = true, .low = -4.0, .high = 28.0},
                           .y = {.fixed = true, .low = 0.0, .high = 1.1},
                           .series = {limit("set-point", &d[n], 1 + TUNE_CONTROLLERS),
                                      line(tune_controller_text[0], &d[n], 1, CHART_FAINT),
                                      line(tune_controller_text[3], &d[n], 4, PI_COLOUR),
                                      line(tune_controller_text[4], &d[n], 5, DEADBEAT_COLOUR)}};
        drawn[n].series[0].mark = CHART_STEPS;
    }
    char caption[600];
    steps_caption(c, caption, sizeof caption);
    const bool ok = page_charts(p, drawn, PANELS, "tune-steps", caption, e);
    for (size_t n = 0; n < PANELS; n++) {
        chart_data_free(&d[n]);
    }
    return ok;
}

static void result_cells(page *p, const loop_result *l)
{
    if (l->outcome == LOOP_TRIPS) {
        page_cell(p, true, "trips");
        page_cell(p, true, "-");
        page_cell(p, true, "-");
        return;
    }
    page_cell(p, true, "%.3g%s", l->rms_percent, l->outcome == LOOP_UNSTABLE ? "*" : "");
    page_cell(p, true, "%.3g", l->overshoot_percent);
    if (l->outcome == LOOP_HOLDS) {
        page_cell(p, true, "%d", l->settling_beside_cycles);
    } else {
        page_cell(p, true, "-");
    }
}

/* The largest steady error of a tuned controller over that of deadbeat control of the true machine. */
static double largest_ratio(const tune_comparison *c)
{
    double largest = 0.0;
    for (int k = 0; k < TUNE_RATIOS - 1; k++) {
        for (int truth = 0; truth < TUNE_TRUTHS && c->held[k]; truth++) {
            const double best = c->at[k][TUNE_CONTROLLERS - 1][truth].rms_percent;
            for (int n = TUNE_CONTROLLERS - 3; n < TUNE_CONTROLLERS - 1; n++) {
                largest = fmax(largest,
                               c->at[k][n][truth].rms_percent / best); /* fmax leaves NAN out: it tripped */
            }
        }
    }
    return largest;
}

static void comparison_table(page *p, const tune_comparison *c)
{
    static const char *const heads[] = {"\tSFFR",        "controller",   "\tnominal: rms", "\tovershoot",
                                        "\tsettling",    "\tL low: rms", "\tovershoot",    "\tsettling",
                                        "\tL high: rms", "\tovershoot",  "\tsettling"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int k = 0; k < TUNE_RATIOS - 1; k++) {
        for (int n = 0; n < TUNE_CONTROLLERS && c->held[k]; n++) {
            page_row_begin(p);
            page_cell(p, true, "%g", tune_ratios[k]);
            page_cell(p, false, "%s", tune_controller_text[n]);
            for (int truth = 0; truth < TUNE_TRUTHS; truth++) {
                result_cells(p, &c->at[k][n][truth]);
            }
            page_row_end(p);
        }
    }
    page_table_end(p);
    page_note(
        p,
        "All at %.0f rpm; the switching frequency sets the SFFR. The true inductance is nominal, or %.0f %% "
        "lower or higher. All controllers use the nominal inductance, except the last. rms: error of the "
        "true mean current, percent of the rated peak. overshoot: percent of the step. settling: cycles "
        "to within 5 %% of the rated peak around the remaining error. *: unstable.",
        c->rpm, 100.0 * c->L_share);
}

static bool parts(page *p, const tune_report *t, error *e)
{
    const tune_result *r = &t->result;
    const tune_trial *trial = &t->trial;
    page_lead(p, "Bandwidth %.0f rad/s at %g Hz, limited by %s.", r->bandwidth_rad_s, r->motor.f_pwm_Hz,
              r->limited_by);
    page_text(
        p,
        "Uncertainty set: %s, by %d machines at %d speeds. Put IQFOC_TUNED_LAW of iqfoc_tuned.h into the "
        "firmware.",
        r->region.source, r->region.points, TUNE_SPEEDS);
    page_heading(p, 2, "Margins over speed");
    if (!margins_figure(p, r, e)) {
        return false;
    }
    margins_table(p, r);
    if (!sensitivity_figure(p, r, e)) {
        return false;
    }
    page_heading(p, 2, "Trial in the plant");
    page_lead(
        p,
        "Largest overshoot: predicted %.1f %%, simulated %.1f %%. Longest settling: predicted %.0f cycles, "
        "simulated %.0f.",
        trial->promised.overshoot_percent, trial->found.overshoot_percent, trial->promised.settling_cycles,
        trial->found.settling_cycles);
    page_text(
        p,
        "%d drives of the uncertainty set, each at its own speed up to %.0f rpm. Unstable: %d. Settled later "
        "than predicted, by more than a tenth and a cycle: %d. Overshot by a tenth of the step more than "
        "predicted: %d. Largest difference between predicted and simulated overshoot: %.1f %% of the step.",
        trial->drives, trial->rpm_most, trial->unstable, trial->late, trial->high, trial->overshoot_off);
    if (!tune_observer_part(p, t, e) || !tune_speed_part(p, t, e)) {
        return false;
    }
    if (t->result.halves) {
        return true; /* the others have one update */
    }
    page_heading(p, 2, "Comparison with other controllers");
    if (!steps_figure(p, t, e)) {
        return false;
    }
    page_text(p,
              "Steady error of the tuned controllers: at most %.2f times that of exact deadbeat control of "
              "the true "
              "machine, over all rows of the table.",
              largest_ratio(&t->comparison));
    comparison_table(p, &t->comparison);
    return true;
}

bool tune_report_page(const tune_report *t, const char *directory, error *e)
{
    page p;
    char title[200];
    (void)snprintf(title, sizeof title, "%s: tuned controller", t->result.motor.name);
    if (!page_begin(&p, directory, title,
                    "A current controller for this machine, with its margins at every speed.", e)) {
        return false;
    }
    return page_finish(&p, parts(&p, t, e), e);
}

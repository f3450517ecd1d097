/* A design as a report page (tune_report.h). */
#include "tune_report.h"

#include "base/number.h"
#include "base/vector.h"
#include "report/page.h"

#include <math.h>

/* ---- Margins over speed ---- */

static bool margins_figure(page *p, const tune_result *r, error *e)
{
    enum { PANELS = 4 };
    static const char *const titles[PANELS] = {"disk margin", "gain margin, dB", "phase margin, degrees",
                                               "delay margin, cycles"};
    chart_data d = chart_data_of(1 + 2 * PANELS);
    chart drawn[PANELS];
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        const tune_at_speed *at = &r->at[s];
        chart_data_add(&d, (double[]){at->rpm, at->worst.disk, at->nominal.disk, at->worst.gain_dB,
                                      at->nominal.gain_dB, at->worst.phase_deg, at->nominal.phase_deg,
                                      at->worst.delay_cycles, at->nominal.delay_cycles});
    }
    for (size_t n = 0; n < PANELS; n++) {
        drawn[n] = (chart){.title = titles[n],
                           .x_label = "rpm",
                           .series = {{"worst of the region", &d, 1 + 2 * n, CHART_BLUE, CHART_LINE_POINTS,
                                       CHART_ALWAYS, 0.0, false},
                                      {"nominal", &d, 2 + 2 * n, CHART_ORANGE, CHART_LINE_POINTS,
                                       CHART_ALWAYS, 0.0, false}}};
    }
    const bool ok =
        page_charts(p, drawn, PANELS, "tune-margins",
                    "How far the voltage may go wrong before the loop is unstable, over the speed. A delay "
                    "margin of 1 stands for at least one cycle.",
                    e);
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
        p,
        "Each margin is the worst over the region, not all of one machine. The slowest pole is that of the "
        "valley's offset, which is learnt over twenty cycles.");
}

/* ---- Sensitivity ---- */

enum { FREQUENCIES = 120 };

static chart_data sensitivity_of(const tune_result *r, const tune_at_speed *at)
{
    chart_data d = chart_data_of(3);
    tune_loop nominal;
    tune_loop worst;
    tune_loop_make(&r->design, &r->region.point[0].machine, at->phi_rad, &tune_no_fault, &nominal);
    tune_loop_make(&r->design, &r->region.point[at->disk_worst].machine, at->phi_rad, &tune_no_fault, &worst);
    for (int k = 0; k < FREQUENCIES; k++) {
        const double w = VEC_PI * pow(10.0, 2.0 * ((double)(k + 1) / FREQUENCIES - 1.0));
        chart_data_add(&d, (double[]){w * r->motor.f_pwm_Hz / VEC_TWO_PI, tune_sensitivity(&nominal, w),
                                      tune_sensitivity(&worst, w)});
    }
    return d;
}

static bool sensitivity_figure(page *p, const tune_result *r, error *e)
{
    enum { SHOWN = 3 };
    static const int speeds[SHOWN] = {0, (TUNE_SPEEDS - 1) / 2, TUNE_SPEEDS - 1};
    static const chart_colour colours[SHOWN] = {CHART_BLUE, CHART_ORANGE, CHART_GREEN};
    chart_data d[SHOWN];
    char label[2 * SHOWN][48];
    chart drawn = {.x_label = "frequency in the rotor frame, Hz",
                   .y_label = "largest singular value",
                   .x = {.logarithmic = true},
                   .y = {.logarithmic = true},
                   .height = 360};
    for (size_t n = 0; n < SHOWN; n++) {
        const tune_at_speed *at = &r->at[speeds[n]];
        d[n] = sensitivity_of(r, at);
        (void)snprintf(label[2 * n], sizeof label[0], "nominal, %.0f rpm", at->rpm);
        (void)snprintf(label[2 * n + 1], sizeof label[0], "worst machine, %.0f rpm", at->rpm);
        drawn.series[2 * n] =
            (chart_series){label[2 * n], &d[n], 1, colours[n], CHART_LINE, CHART_ALWAYS, 0.0, true};
        drawn.series[2 * n + 1] =
            (chart_series){label[2 * n + 1], &d[n], 2, colours[n], CHART_LINE, CHART_ALWAYS, 0.0, false};
    }
    const bool ok =
        page_chart(p, &drawn, "tune-sensitivity",
                   "Sensitivity of the voltage to a disturbance of it: below 1 the loop takes it away, "
                   "above 1 it adds to it.",
                   e);
    for (size_t n = 0; n < SHOWN; n++) {
        chart_data_free(&d[n]);
    }
    return ok;
}

/* ---- Steps and comparison ---- */

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
        d[n] = chart_data_of(1 + TUNE_CONTROLLERS);
        for (int k = 0; k < LOOP_TRACE_CYCLES - 12 && c->held[ratio]; k++) {
            double row[1 + TUNE_CONTROLLERS] = {k - LOOP_TRACE_BEFORE};
            for (int how = 0; how < TUNE_CONTROLLERS; how++) {
                row[1 + how] = c->at[ratio][how][0].trace_q[k];
            }
            chart_data_add(&d[n], row);
        }
        (void)snprintf(title[n], sizeof title[n],
                       c->held[ratio] ? "%g cycles a turn" : "%g cycles a turn: not held",
                       tune_ratios[ratio]);
        drawn[n] = (chart){
            .title = title[n],
            .x_label = "cycles after the step",
            .y_label = "i_q over rated",
            .x = {.fixed = true, .low = -4.0, .high = 28.0},
            .y = {.fixed = true, .low = 0.2, .high = 1.0},
            .series = {
                {tune_controller_text[0], &d[n], 1, CHART_FAINT, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false},
                {tune_controller_text[3], &d[n], 4, CHART_BLUE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false},
                {tune_controller_text[4], &d[n], 5, CHART_ORANGE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0,
                 false}}};
    }
    const bool ok = page_charts(
        p, drawn, PANELS, "tune-steps",
        "Step of i_q from 0.3 to 0.7 of the rated peak, nominal machine, switching-level drive and "
        "firmware in fixed point: the true mean of each cycle.",
        e);
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
    page_note(p,
              "%.0f rpm; the switching frequency makes the ratio. True inductance nominal, %.0f %% lower and "
              "higher; all "
              "controllers but the last believe the nominal one. rms error in percent of the rated peak, "
              "overshoot in "
              "percent of the step, settling in cycles to within 5 %% of the rated peak beside what remains. "
              "*: unstable.",
              c->rpm, 100.0 * c->L_share);
}

static bool parts(page *p, const tune_report *t, error *e)
{
    const tune_result *r = &t->result;
    const tune_trial *trial = &t->trial;
    page_lead(p, "Bandwidth %.0f rad/s at %g Hz, limited by %s.", r->bandwidth_rad_s, r->motor.f_pwm_Hz,
              r->limited_by);
    page_text(
        p, "Region: %s, by %d machines at %d speeds. Put IQFOC_TUNED_LAW of iqfoc_tuned.h into the firmware.",
        r->region.source, r->region.points, TUNE_SPEEDS);
    page_heading(p, 2, "Margins over speed");
    if (!margins_figure(p, r, e)) {
        return false;
    }
    margins_table(p, r);
    if (!sensitivity_figure(p, r, e)) {
        return false;
    }
    page_heading(p, 2, "Tried");
    page_lead(p,
              "%d drives of the region, each at a speed of its own up to %.0f rpm: %d unstable, %d settled "
              "later than "
              "promised, %d overshot by more.",
              trial->drives, trial->rpm_most, trial->unstable, trial->late, trial->high);
    page_text(p,
              "The worst of them was promised an overshoot of %.1f %% and %.0f cycles to settle; found were "
              "%.1f %% and "
              "%.0f. No drive's overshoot was off its promise by more than %.1f %% of the step.",
              trial->promised.overshoot_percent, trial->promised.settling_cycles,
              trial->found.overshoot_percent, trial->found.settling_cycles, trial->overshoot_off);
    page_heading(p, 2, "Beside other controllers");
    if (!steps_figure(p, t, e)) {
        return false;
    }
    comparison_table(p, &t->comparison);
    return true;
}

bool tune_report_page(const tune_report *t, const char *directory, error *e)
{
    page p;
    char title[200];
    (void)snprintf(title, sizeof title, "%s, tuned", t->result.motor.name);
    if (!page_begin(&p, directory, title, "A current controller with the margins it has at every speed.",
                    e)) {
        return false;
    }
    return page_finish(&p, parts(&p, t, e), e);
}

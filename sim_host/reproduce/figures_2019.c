/* 2019: Figs. 3 (PWM) and 6 (error waveforms), and the paper's section of the page. */
#include "figures.h"
#include "figures_2019_speed.h"
#include "paper_2019.h"
#include "rows_page.h"

#include <math.h>

static const double full_speed_rpm = 8000.0;

/* ---- Fig. 3 ---- */

enum { SHOWN_CYCLES = 4 };

static void add_point(void *context, const drive_point *point)
{
    chart_data_add(context, (double[]){1e3 * point->t_s, point->u_A_V, point->i_A_A});
}

/* The state of a leg, above a height of its own. */
static chart_data leg_of(const steady_drive *d, int x)
{
    const double off = 1.25 * (2 - x);
    const double T_ms = 1e3 * d->T_s;
    chart_data leg = chart_data_of(2);
    for (int n = 0; n < SHOWN_CYCLES; n++) {
        double duty[3];
        steady_drive_duties(d, &d->cycle[n], duty);
        chart_data_add(&leg, (double[]){n * T_ms, off});
        chart_data_add(&leg, (double[]){(n + 0.5 * (1.0 - duty[x])) * T_ms, off + 1.0});
        chart_data_add(&leg, (double[]){(n + 0.5 * (1.0 + duty[x])) * T_ms, off});
    }
    chart_data_add(&leg, (double[]){SHOWN_CYCLES * T_ms, off});
    return leg;
}

/* Samples at valleys (first) or peaks, and each cycle's mean from its beginning on. */
static chart_data samples_of(const steady_drive *d, bool valleys)
{
    chart_data s = chart_data_of(3);
    for (int n = 0; n < SHOWN_CYCLES; n++) {
        const drive_cycle *at = &d->cycle[n];
        chart_data_add(&s, (double[]){1e3 * (n + (valleys ? 0.0 : 0.5)) * d->T_s,
                                      creal(valleys ? at->i_valley_A : at->i_mid_A), creal(at->i_mean_A)});
    }
    if (valleys) {
        chart_data_add(
            &s, (double[]){1e3 * SHOWN_CYCLES * d->T_s, NAN, creal(d->cycle[SHOWN_CYCLES - 1].i_mean_A)});
    }
    return s;
}

static bool figure_3(page *p, const motor *m, const steady_drive *d, error *e)
{
    static const char *const names[3] = {"S_A", "S_B", "S_C"};
    chart_data leg[3] = {leg_of(d, 0), leg_of(d, 1), leg_of(d, 2)};
    chart_data wave = chart_data_of(3);
    chart_data valleys = samples_of(d, true);
    chart_data peaks = samples_of(d, false);
    steady_drive_trace(m, d, 0, SHOWN_CYCLES, d->T_s / 40.0, add_point, &wave);
    const chart usual = {.x_label = "t, ms",
                         .group = "2019-3",
                         .x = {.fixed = true, .low = 0.0, .high = 1e3 * SHOWN_CYCLES * d->T_s},
                         .height = 170};
    chart drawn[3] = {usual, usual, usual};
    drawn[0].y_label = "switched high";
    drawn[0].y = (chart_axis){.fixed = true, .low = -0.2, .high = 3.7};
    for (size_t x = 0; x < 3; x++) {
        drawn[0].series[x] =
            (chart_series){names[x], &leg[x], 1, (chart_colour)x, CHART_STEPS, CHART_ALWAYS, 0.0, false};
    }
    drawn[1].y_label = "u_A, V";
    drawn[1].series[0] = (chart_series){"u_A", &wave, 1, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false};
    drawn[2].y_label = "i_A, A";
    drawn[2].height = 240;
    drawn[2].series[0] =
        (chart_series){"mean", &valleys, 2, CHART_FAINT, CHART_STEPS, CHART_ALWAYS, 2.4, false};
    drawn[2].series[1] = (chart_series){"i_A", &wave, 2, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false};
    drawn[2].series[2] =
        (chart_series){"valley sample", &valleys, 1, CHART_ORANGE, CHART_POINTS, CHART_ALWAYS, 0.0, false};
    drawn[2].series[3] =
        (chart_series){"peak sample", &peaks, 1, CHART_GREEN, CHART_POINTS, CHART_ALWAYS, 0.0, false};
    page_heading(p, 3, "Switching and sampling at 8000 rpm");
    const bool ok = page_charts(
        p, drawn, 3, "2019-figure-3",
        "Figure 3. PWM signals, voltage and current of phase A at 8000 rpm (12.5 switching periods a "
        "fundamental period). The mid-point sample differs from the cycle's mean by the curvature of the "
        "current.",
        e);
    for (int x = 0; x < 3; x++) {
        chart_data_free(&leg[x]);
    }
    chart_data_free(&wave);
    chart_data_free(&valleys);
    chart_data_free(&peaks);
    return ok;
}

/* ---- Fig. 6 ---- */

static bool figure_6(page *p, const comparison *c, const method_machine *machine, const steady_drive *d,
                     error *e)
{
    enum { SHOWN = 50, PANELS = 3 };
    chart_data errors = chart_data_of(2 + METHOD_COUNT);
    for (int n = 0; n <= SHOWN; n++) {
        const method_input in = method_input_of(d, &d->cycle[n]);
        double row[2 + METHOD_COUNT] = {1e3 * n * d->T_s, creal(d->cycle[n].i_valley_A)};
        for (int k = 0; k < METHOD_COUNT; k++) {
            row[2 + k] =
                creal(method_compute((method)k, machine, &in) - method_truth((method)k, &d->cycle[n]));
        }
        chart_data_add(&errors, row);
    }
    const chart usual = {.x_label = "t, ms", .group = "2019-6", .height = 200};
    chart drawn[PANELS] = {usual, usual, usual};
    drawn[0].y_label = "i_A, A";
    drawn[0].series[0] = (chart_series){
        "sampled phase current", &errors, 1, CHART_FAINT, CHART_STEPS, CHART_ALWAYS, 0.0, false};
    drawn[1].y_label = "error of the mean, A";
    drawn[2].y_label = "error of prediction, A";
    for (size_t n = 1; n < PANELS; n++) {
        drawn[n].series[0] =
            (chart_series){"standard", &errors, 2 * n, CHART_BLUE, CHART_STEPS, CHART_ALWAYS, 0.0, false};
        drawn[n].series[1] = (chart_series){"quasi-discrete", &errors,      2 * n + 1, CHART_ORANGE,
                                            CHART_STEPS,      CHART_ALWAYS, 0.0,       false};
    }
    page_heading(p, 3, "Errors over time");
    const bool ok =
        rows_page_charts(p, drawn, PANELS, "2019-figure-6",
                         "Figure 6. Errors of mean current and prediction of phase A at 8000 rpm, rated "
                         "current, four fundamental periods.",
                         c, "2019", "Figure 6", NULL, e);
    chart_data_free(&errors);
    return ok;
}

bool figures_2019(page *p, const comparison *c, error *e)
{
    const motor m = paper_2019_motor();
    method_machine machine;
    steady_drive d;
    page_heading(p, 2, "2019: quasi-discrete modelling at low frequency ratio");
    page_text(p,
              "The quasi-discrete model lets the EMF turn with the rotor within a control cycle. The drive "
              "is the paper's laboratory drive, its PWM resolved at every edge; current regulated at the "
              "mid-point sample.");
    if (!method_machine_of(&m, &machine, e) ||
        !steady_drive_run(&m, full_speed_rpm, paper_2019_current(&m, full_speed_rpm), 200, &d, e)) {
        return false;
    }
    const bool ok = figure_3(p, &m, &d, e) && figure_6(p, c, &machine, &d, e) &&
                    figure_2019_7(p, c, &m, &machine, e) && figure_2019_9(p, c, &m, &machine, e);
    steady_drive_free(&d);
    if (ok) {
        page_heading(p, 3, "The firmware against double precision");
        rows_page_table(p, c, "2019", "IQ24 against double", NULL);
    }
    return ok;
}

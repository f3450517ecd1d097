/* The run-ups printed, as JSON, and on the page (run_up_show.h). */
#include "run_up_show.h"

#include "base/json_file.h"

enum { SHOWN_LINEAR = 0, SHOWN_SIX_STEP = 1, SHOWN_TIMER = 6 };

void run_ups_print(const run_up all[RUN_UP_CASES], FILE *f)
{
    fprintf(f,
            "\nRun-up to %g rpm and down again at rated torque, %g V; torque above %g rpm, percent of rated\n"
            "  %-36s%10s%10s%10s%12s%12s\n",
            RUN_UP_RPM, RUN_UP_U_DC, RUN_UP_FROM_RPM, "modulation", "more", "less", "least i_d", "voltage",
            "pulses/turn");
    for (int n = 0; n < RUN_UP_CASES; n++) {
        const run_up *r = &all[n];
        fprintf(f, "  %-36s%10.2f%10.2f%10.3f%12.4f%12.2f\n", run_up_cases[n].text, r->step_up_percent,
                r->step_down_percent, r->i_d_least, r->voltage_most, r->pulses_top);
    }
}

json_t *run_ups_json(const run_up all[RUN_UP_CASES])
{
    json_t *list = json_array();
    for (int n = 0; n < RUN_UP_CASES && list != NULL; n++) {
        const run_up *r = &all[n];
        json_t *o = json_pack("{s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:o}",
                              "case", run_up_cases[n].key, "text", run_up_cases[n].text, "step_percent",
                              run_up_step_percent(r), "more_percent", r->step_up_percent, "less_percent",
                              r->step_down_percent, "i_d_least", r->i_d_least, "voltage_most",
                              r->voltage_most, "pulses_per_turn", r->pulses_top, "top_rpm", r->top_rpm,
                              "share", run_up_cases[n].share, "linear_to_rpm", json_number(r->linear_to_rpm),
                              "six_step_from_rpm", json_number(r->six_step_from_rpm), "to_timer_rpm",
                              json_number(r->to_timer_rpm), "to_carrier_rpm", json_number(r->to_carrier_rpm));
        list = json_appended(list, o);
    }
    return list;
}

/* ---- The page ---- */

enum {
    RUN_UP_T,
    RUN_UP_SPEED,
    RUN_UP_ASKED,
    RUN_UP_TORQUE,
    RUN_UP_ERROR,
    RUN_UP_I_D,
    RUN_UP_VOLTAGE,
    RUN_UP_COLUMNS
};

static chart_data points_of(const run_up *r)
{
    chart_data d = chart_data_of(RUN_UP_COLUMNS);
    for (int n = 0; n < r->points; n++) {
        const run_up_point *at = &r->point[n];
        chart_data_add(&d, (double[RUN_UP_COLUMNS]){at->t_s, at->rpm / 1000.0, at->asked, at->torque,
                                                    100.0 * (at->torque - at->asked), at->i_d, at->voltage});
    }
    return d;
}

static chart_series linear(const chart_data *d, size_t column)
{
    return (chart_series){"linear modulation", d, column, CHART_ORANGE, CHART_LINE, CHART_ALWAYS, 0.0, false};
}

static chart_series six_step(const chart_data *d, size_t column, const char *label)
{
    return (chart_series){label, d, column, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false};
}

static chart_series timer(const chart_data *d, size_t column)
{
    return (chart_series){"by a timer", d, column, CHART_GREEN, CHART_LINE, CHART_ALWAYS, 0.0, false};
}

/* Five charts over one axis of time. */
static bool draw_run_ups(page *p, const chart_data *lin, const chart_data *six, const chart_data *timed,
                         const char *caption, error *e)
{
    enum { PANELS = 5 };
    const double end_s = six->rows > 0 ? six->value[(six->rows - 1) * six->columns] : 1.0;
    const chart usual = {.x_label = "t, s", .group = "run-up", .height = 190};
    chart drawn[PANELS] = {usual, usual, usual, usual, usual};
    /* The voltage of linear modulation and of six-step: 1/sqrt 3 and 2/pi of the DC link. */
    chart_data limits = chart_data_of(3);
    chart_data_add(&limits, (double[]){0.0, 0.57735, 0.63662});
    chart_data_add(&limits, (double[]){end_s, 0.57735, 0.63662});
    drawn[0].y_label = "speed, 1000 rpm";
    drawn[0].series[0] = six_step(six, RUN_UP_SPEED, "speed");
    drawn[1].y_label = "torque over rated";
    drawn[1].series[0] =
        (chart_series){"asked for", six, RUN_UP_ASKED, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 2.4, false};
    drawn[1].series[1] = six_step(six, RUN_UP_TORQUE, "made, to six-step");
    drawn[2].y_label = "torque error, %";
    drawn[2].y = (chart_axis){.fixed = true, .low = -3.0, .high = 3.0};
    drawn[2].series[0] = linear(lin, RUN_UP_ERROR);
    drawn[2].series[1] = six_step(six, RUN_UP_ERROR, "to six-step");
    drawn[2].series[2] = timer(timed, RUN_UP_ERROR);
    drawn[3].y_label = "voltage over u_dc";
    drawn[3].series[0] =
        (chart_series){"linear range", &limits, 1, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0, false};
    drawn[3].series[1] =
        (chart_series){"six-step", &limits, 2, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0, true};
    drawn[3].series[2] = linear(lin, RUN_UP_VOLTAGE);
    drawn[3].series[3] = six_step(six, RUN_UP_VOLTAGE, "to six-step");
    drawn[3].series[4] = timer(timed, RUN_UP_VOLTAGE);
    drawn[4].y_label = "i_d over rated";
    drawn[4].series[0] = linear(lin, RUN_UP_I_D);
    drawn[4].series[1] = six_step(six, RUN_UP_I_D, "to six-step");
    drawn[4].series[2] = timer(timed, RUN_UP_I_D);
    const bool ok = page_charts(p, drawn, PANELS, "loops-run-up", caption, e);
    chart_data_free(&limits);
    return ok;
}

static bool run_up_figure(page *p, const run_up all[RUN_UP_CASES], error *e)
{
    char caption[384];
    (void)snprintf(
        caption, sizeof caption,
        "From standstill to %g rpm and down again at rated torque, %g V: means over a bell of %d "
        "cycles. The voltage leaves the linear range at %.0f rpm, and six-step begins at %.0f rpm. By a "
        "timer: six-step begins at %.0f rpm, and the carrier resumes at %.0f rpm on the way down.",
        RUN_UP_RPM, RUN_UP_U_DC, (int)RUN_UP_BELL, all[SHOWN_SIX_STEP].linear_to_rpm,
        all[SHOWN_SIX_STEP].six_step_from_rpm, all[SHOWN_TIMER].to_timer_rpm,
        all[SHOWN_TIMER].to_carrier_rpm);
    chart_data lin = points_of(&all[SHOWN_LINEAR]);
    chart_data six = points_of(&all[SHOWN_SIX_STEP]);
    chart_data timed = points_of(&all[SHOWN_TIMER]);
    const bool ok = draw_run_ups(p, &lin, &six, &timed, caption, e);
    chart_data_free(&timed);
    chart_data_free(&lin);
    chart_data_free(&six);
    return ok;
}

bool run_ups_part(page *p, const run_up all[RUN_UP_CASES], error *e)
{
    static const char *const heads[] = {"modulation",  "\tmore torque, %", "\tless, %",
                                        "\tleast i_d", "\tvoltage",        "\tpulses a turn"};
    page_heading(p, 2, "Run-up into six-step");
    page_lead(p, "Largest torque deviation on the way to six-step and back: %.1f %% of rated.",
              run_up_step_percent(&all[SHOWN_SIX_STEP]));
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int n = 0; n < RUN_UP_CASES; n++) {
        const run_up *r = &all[n];
        page_row_begin(p);
        page_cell(p, false, "%s", run_up_cases[n].text);
        page_cell(p, true, "%.2f", r->step_up_percent);
        page_cell(p, true, "%.2f", -r->step_down_percent);
        page_cell(p, true, "%.3f", r->i_d_least);
        page_cell(p, true, "%.4f", r->voltage_most);
        page_cell(p, true, "%.2f", r->pulses_top);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p,
              "Largest deviations of the torque in percent of rated, smoothed over %d cycles, above %g rpm, "
              "without the reversal. i_d: over the rated peak. Voltage: fundamental over u_dc. Pulses: per "
              "leg and electrical turn at the top.",
              (int)RUN_UP_BELL, RUN_UP_FROM_RPM);
    return run_up_figure(p, all, e);
}

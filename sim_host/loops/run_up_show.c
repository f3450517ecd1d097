/* The run-ups printed, as JSON, and on the page (run_up_show.h). */
#include "run_up_show.h"

#include "base/json_file.h"

enum { SHOWN_LINEAR = 0, SHOWN_SIX_STEP = 1 };

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
        json_t *o = json_pack("{s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:o, s:o}", "case",
                              run_up_cases[n].key, "text", run_up_cases[n].text, "step_percent",
                              run_up_step_percent(r), "more_percent", r->step_up_percent, "less_percent",
                              r->step_down_percent, "i_d_least", r->i_d_least, "voltage_most",
                              r->voltage_most, "pulses_per_turn", r->pulses_top, "top_rpm", r->top_rpm,
                              "share", run_up_cases[n].share, "linear_to_rpm", json_number(r->linear_to_rpm),
                              "six_step_from_rpm", json_number(r->six_step_from_rpm));
        if (o == NULL || json_array_append_new(list, o) != 0) {
            json_free(list);
            return NULL;
        }
    }
    return list;
}

static void say_points(plot *drawing, const char *name, const run_up *r)
{
    plot_data(drawing, name);
    for (int n = 0; n < r->points; n++) {
        const run_up_point *at = &r->point[n];
        plot_say(drawing, "%.4f %.5g %.4f %.4f %.4f %.4f\n", at->t_s, at->rpm, at->asked, at->torque, at->i_d,
                 at->voltage);
    }
    plot_data_end(drawing);
}

/* A panel between two heights of the picture, in its own range. */
static void say_panel(plot *drawing, double top, double bottom, const char *axis)
{
    plot_say(drawing, "set tmargin at screen %g\nset bmargin at screen %g\n%s\n", top, bottom, axis);
}

/* Five panels over one axis of time. */
static void say_panels(plot *drawing)
{
    plot_say(drawing, "set multiplot\nset lmargin at screen 0.10\nset rmargin at screen 0.985\n"
                      "set xrange [0:3.8]\nset format x ''\n");
    say_panel(drawing, 0.99, 0.85, "set ylabel 'speed, 1000 rpm'\nset ytics 4\nset yrange [0:8.8]");
    plot_say(drawing, "plot $six using 1:($2/1000) with lines linestyle 1 notitle\n");
    say_panel(drawing, 0.83, 0.67,
              "set ylabel 'torque over rated'\nset yrange [-1.3:1.3]\nset ytics 1\n"
              "set key at graph 0.02, graph 0.5 left");
    plot_say(drawing, "plot $six using 1:3 with lines linestyle 9 linewidth 2.4 title 'asked for', "
                      "$six using 1:4 with lines linestyle 1 title 'made, to six-step'\n");
    say_panel(drawing, 0.65, 0.49,
              "set ylabel 'torque error, %'\nset yrange [-3:3]\nset ytics 2\n"
              "set key at graph 0.02, graph 0.38 left");
    plot_say(drawing, "plot $linear using 1:(100*($4-$3)) with lines linestyle 2 title 'linear modulation', "
                      "$six using 1:(100*($4-$3)) with lines linestyle 1 title 'to six-step'\n");
    say_panel(drawing, 0.47, 0.29,
              "set ylabel 'voltage over u_{dc}'\nset yrange [0:0.74]\nset ytics 0.2\n"
              "set key at graph 0.42, graph 0.62 left");
    plot_say(drawing, "plot 0.57735 with lines linestyle 9 title 'linear range', "
                      "0.63662 with lines linestyle 9 dashtype 2 title 'six-step', "
                      "$linear using 1:6 with lines linestyle 2 title 'linear modulation', "
                      "$six using 1:6 with lines linestyle 1 title 'to six-step'\n");
    say_panel(drawing, 0.27, 0.075,
              "set ylabel 'i_d over rated'\nset yrange [-0.62:0.1]\nset format x '%g'\nset xlabel 't, s'\n"
              "set key at graph 0.02, graph 0.5 left");
    plot_say(drawing, "plot $linear using 1:5 with lines linestyle 2 title 'linear modulation', "
                      "$six using 1:5 with lines linestyle 1 title 'to six-step'\nunset multiplot\n");
}

static bool run_up_figure(page *p, const run_up all[RUN_UP_CASES], error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 720, 860, e)) {
        return false;
    }
    say_points(&drawing, "linear", &all[SHOWN_LINEAR]);
    say_points(&drawing, "six", &all[SHOWN_SIX_STEP]);
    say_panels(&drawing);
    char caption[256];
    (void)snprintf(
        caption, sizeof caption,
        "From standstill to %g rpm and down again at rated torque, %g V: means over a bell of %d "
        "cycles. The voltage leaves the linear range at %.0f rpm and is six-step's from %.0f rpm on.",
        RUN_UP_RPM, RUN_UP_U_DC, (int)RUN_UP_BELL, all[SHOWN_SIX_STEP].linear_to_rpm,
        all[SHOWN_SIX_STEP].six_step_from_rpm);
    return page_figure(p, &drawing, "loops-run-up", caption, e);
}

bool run_ups_part(page *p, const run_up all[RUN_UP_CASES], error *e)
{
    static const char *const heads[] = {"modulation",  "\tmore torque, %", "\tless, %",
                                        "\tleast i_d", "\tvoltage",        "\tpulses a turn"};
    page_heading(p, 2, "Run-up into six-step");
    page_lead(
        p,
        "Through overmodulation into six-step and back the torque leaves its reference by %.1f %% of rated.",
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
    page_note(
        p,
        "Largest deviations of the torque, smoothed over %d cycles, above %g rpm, but around the reversal; "
        "percent of rated. i_d over the rated peak. Voltage: fundamental over u_dc. Pulses per leg and "
        "electrical turn at the top.",
        (int)RUN_UP_BELL, RUN_UP_FROM_RPM);
    return run_up_figure(p, all, e);
}

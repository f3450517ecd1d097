/* 2019: Figs. 7 and 9 (figures_2019_speed.h). */
#include "figures_2019_speed.h"

#include "lab_drives.h"
#include "paper_2019.h"
#include "rows_page.h"
#include "sweep.h"

#include <math.h>

static const double highest_rpm = 8000.0;
static const double lowest_rpm = 500.0;

enum { SPEEDS = 24 };

/* Speeds whose ratios lie evenly on a logarithmic axis from 12.5 to 200. */
static double speed_at(int n)
{
    return highest_rpm * pow(lowest_rpm / highest_rpm, (double)n / (SPEEDS - 1));
}

static void say_errors(plot *p, const sweep_point *at)
{
    plot_say(p, "%.6g", at->sffr);
    for (int k = 0; k < METHOD_COUNT; k++) {
        plot_say(p, " %.6g", at->errors.of[k].rms_percent);
    }
    plot_say(p, "\n");
}

static bool say_sweep(plot *p, const motor *m, const method_machine *machine, bool weakened, error *e)
{
    bool ok = true;
    plot_data(p, weakened ? "errors" : "plain");
    for (int n = 0; n < SPEEDS && ok; n++) {
        const double rpm = speed_at(n);
        sweep_point at;
        ok = sweep_point_at(m, machine, rpm,
                            weakened ? paper_2019_current(m, rpm) : paper_2019_current_at(m, 0.0), &at, e);
        if (ok) {
            say_errors(p, &at);
        }
    }
    plot_data_end(p);
    return ok;
}

static void say_paper(plot *p, const motor *m)
{
    plot_data(p, "paper");
    for (int n = 0; n < PAPER_2019_TABLE_1; n++) {
        plot_say(p, "%.6g", paper_2019_sffr(m, paper_2019_table_1[n].n_rpm));
        for (int k = 0; k < METHOD_COUNT; k++) {
            plot_say(p, " %g", paper_2019_table_1[n].percent[k]);
        }
        plot_say(p, "\n");
    }
    plot_data_end(p);
    plot_data(p, "measured");
    for (int n = 0; n < PAPER_2019_TABLE_3; n++) {
        const struct paper_2019_measured *at = &paper_2019_table_3[n];
        plot_say(p, "%.6g %g %g\n", paper_2019_sffr(m, at->n_rpm), at->standard, at->quasi_discrete);
    }
    plot_data_end(p);
}

static void say_error_panel(plot *p, int column, const char *title, bool with_key)
{
    plot_say(p,
             "set title '%s'\n%s\nplot $errors using 1:%d with lines linestyle 1 title 'standard', "
             "$errors using 1:%d with lines linestyle 2 title 'quasi-discrete', "
             "$paper using 1:%d with points linestyle 1 title 'paper, Table 1', "
             "$paper using 1:%d with points linestyle 2 notitle, "
             "$plain using 1:%d with lines linestyle 9 dashtype 2 title 'with i_d = 0', "
             "$plain using 1:%d with lines linestyle 9 dashtype 2 notitle\n",
             title, with_key ? "set key top right font ',11'" : "unset key", column, column + 1, column,
             column + 1, column, column + 1);
}

static bool draw_figure_7(page *p, const motor *m, const method_machine *machine, bool logarithmic, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 620, 330, e)) {
        return false;
    }
    if (!say_sweep(&drawing, m, machine, true, e) || !say_sweep(&drawing, m, machine, false, e)) {
        plot_abandon(&drawing);
        return false;
    }
    say_paper(&drawing, m);
    plot_say(&drawing, "%s",
             logarithmic ? "set logscale xy\nset xrange [11.5:220]\nset xtics (12.5,20,50,100,200)\n"
                           "set format y '%g'\n"
                         : "set xrange [10:50]\nset xtics 10\nset yrange [0:*]\n");
    plot_say(&drawing, "set xlabel 'SFFR'\nset ylabel 'error, %% of the rms current'\n"
                       "set multiplot layout 1,2 margins 0.11,0.985,0.15,0.91 spacing 0.14,0\n");
    say_error_panel(&drawing, 2, "(a) mean current", false);
    say_error_panel(&drawing, 4, "(b) prediction", true);
    plot_say(&drawing, "unset multiplot\n");
    return logarithmic ? page_figure(p, &drawing, "2019-figure-7-log",
                                     "The same down to 500 rpm, both axes logarithmic. The paper's "
                                     "standard figures at SFFR 200 lie on the curve of SFFR 100.",
                                     e)
                       : page_figure(p, &drawing, "2019-figure-7",
                                     "Figure 7. Errors over the switching-to-fundamental frequency ratio "
                                     "(SFFR), rated current: mean current (a), prediction (b). Dots: the "
                                     "paper's Table 1.",
                                     e);
}

bool figure_2019_7(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e)
{
    page_heading(p, 3, "Errors over speed");
    page_pair_begin(p);
    if (!draw_figure_7(p, m, machine, false, e) || !draw_figure_7(p, m, machine, true, e)) {
        return false;
    }
    page_pair_beside(p);
    rows_page_table(p, c, "2019", "Table 1", NULL);
    page_pair_end(p);
    return true;
}

static bool say_spread(plot *p, const motor *m, method which, const char *name, error *e)
{
    bool ok = true;
    plot_data(p, name);
    for (int n = 0; n < SPEEDS && ok; n++) {
        const double rpm = speed_at(n);
        steady_drive d;
        lab_spread s;
        if (rpm < 1900.0) {
            continue; /* outside the figure */
        }
        ok = steady_drive_run(m, rpm, paper_2019_current(m, rpm), 100, &d, e);
        if (ok) {
            ok = lab_spread_of(m, &d, which, &s, e);
            steady_drive_free(&d);
        }
        if (ok) {
            plot_say(p, "%.6g %.6g %.6g %.6g\n", 1.0 / d.turns_per_cycle, s.low, s.median, s.high);
        }
    }
    plot_data_end(p);
    return ok;
}

bool figure_2019_9(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 620, 330, e)) {
        return false;
    }
    if (!say_sweep(&drawing, m, machine, true, e) ||
        !say_spread(&drawing, m, METHOD_PREDICTION_STANDARD, "standard", e) ||
        !say_spread(&drawing, m, METHOD_PREDICTION_QUASI_DISCRETE, "quasi", e)) {
        plot_abandon(&drawing);
        return false;
    }
    say_paper(&drawing, m);
    plot_say(&drawing, "set xrange [10:50]\nset xtics 10\nset yrange [0:*]\nset xlabel 'SFFR'\n"
                       "set key top right font ',11'\n"
                       "set multiplot layout 1,2 margins 0.11,0.985,0.15,0.91 spacing 0.14,0\n");
    for (int k = 0; k < 2; k++) {
        const char *name = k == 0 ? "standard" : "quasi";
        plot_say(&drawing,
                 "set title '%s'\nset ylabel 'prediction, %% of the rms current'\n"
                 "plot $%s using 1:2:4 with filledcurves linecolor rgb '" PLOT_BAND
                 "' title '90%% of drives', $%s using 1:3 with lines linestyle 2 title 'their median', "
                 "$errors using 1:%d with lines linestyle 1 title 'simulation', $measured using 1:%d "
                 "with points linestyle 4 pointsize 0.8 title 'measured'\n",
                 k == 0 ? "(a) standard" : "(b) quasi-discrete", name, name, 4 + k, 2 + k);
    }
    plot_say(&drawing, "unset multiplot\n");
    page_heading(p, 3, "In place of the laboratory");
    page_text(p,
              "What the laboratory's noise and parameter errors were, the paper does not say. %d drives "
              "are drawn (seed %d) whose controllers know R to ±10 %%, L to ±5 %%, ψ to ±2 %%, the "
              "voltage to ±1 %% and the angle to ±1° (each uniform), with 0.5 %% of the rated peak as "
              "noise on each current sample. Nothing is fitted to the measured points.",
              LAB_DRAWS, (int)LAB_SEED);
    return rows_page_figure(p, &drawing, "2019-figure-9",
                            "Figure 9. Prediction errors as they might be measured, and the two points that "
                            "the paper gives in numbers (Table 3).",
                            c, "2019", "Table 3", NULL, e);
}

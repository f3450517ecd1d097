/* 2019: Figs. 3 (PWM) and 6 (error waveforms), and the paper's section of the page. */
#include "figures.h"
#include "figures_2019_speed.h"
#include "paper_2019.h"
#include "rows_page.h"

#include <math.h>

static const double full_speed_rpm = 8000.0;

/* ---- Fig. 3 ---- */

enum { SHOWN_CYCLES = 4 };

static void say_point(void *context, const drive_point *point)
{
    plot_say(context, "%.7g %.6g %.6g\n", 1e3 * point->t_s, point->u_A_V, point->i_A_A);
}

/* Edges of the three legs, and where valleys and peaks are sampled. */
static void say_switching(plot *p, const steady_drive *d)
{
    for (int x = 0; x < 3; x++) {
        char name[16];
        snprintf(name, sizeof name, "leg%d", x);
        plot_data(p, name);
        for (int n = 0; n < SHOWN_CYCLES; n++) {
            double duty[3];
            steady_drive_duties(d, &d->cycle[n], duty);
            const double t_ms = 1e3 * n * d->T_s;
            const double T_ms = 1e3 * d->T_s;
            plot_say(p, "%.7g 0\n%.7g 1\n%.7g 0\n", t_ms, t_ms + 0.5 * T_ms * (1.0 - duty[x]),
                     t_ms + 0.5 * T_ms * (1.0 + duty[x]));
        }
        plot_say(p, "%.7g 0\n", 1e3 * SHOWN_CYCLES * d->T_s);
        plot_data_end(p);
    }
    plot_data(p, "samples");
    for (int n = 0; n < SHOWN_CYCLES; n++) {
        const drive_cycle *at = &d->cycle[n];
        plot_say(p, "%.7g %.6g %.7g %.6g %.6g %.7g\n", 1e3 * n * d->T_s, creal(at->i_valley_A),
                 1e3 * (n + 0.5) * d->T_s, creal(at->i_mid_A), creal(at->i_mean_A), 1e3 * (n + 1) * d->T_s);
    }
    plot_data_end(p);
}

static bool figure_3(page *p, const motor *m, const steady_drive *d, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 620, 470, e)) {
        return false;
    }
    say_switching(&drawing, d);
    plot_data(&drawing, "wave");
    steady_drive_trace(m, d, 0, SHOWN_CYCLES, d->T_s / 40.0, say_point, &drawing);
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set multiplot\nset lmargin at screen 0.13\nset rmargin at screen 0.985\n"
             "set xrange [0:%g]\nset xtics %g\nset format x ''\nset yrange [-0.15:1.15]\nunset ytics\n"
             "unset key\n",
             1e3 * SHOWN_CYCLES * d->T_s, 1e3 * d->T_s);
    for (int x = 0; x < 3; x++) {
        plot_say(&drawing,
                 "set tmargin at screen %g\nset bmargin at screen %g\n"
                 "set ylabel 'S_%c' rotate by 0 offset -1,0\nplot $leg%d using 1:2 with steps linestyle %d\n",
                 0.985 - 0.085 * x, 0.91 - 0.085 * x, 'A' + x, x, 1 + x);
    }
    plot_say(&drawing,
             "set ytics nomirror 250\nset yrange [-550:550]\nset tmargin at screen 0.72\n"
             "set bmargin at screen 0.47\nset ylabel 'u_A, V' rotate offset 0.6,0\n"
             "plot $wave using 1:2 with lines linestyle 1\n"
             "set tmargin at screen 0.39\nset bmargin at screen 0.11\nset ytics nomirror 4\n"
             "set yrange [*:*]\nset format x '%%g'\nset xlabel 't, ms'\nset ylabel 'i_A, A'\n"
             "set key at graph 1,1.22 horizontal maxrows 1 samplen 1.2 width -3 font ',11'\n"
             "plot $samples using 1:5:($6-$1):(0) with vectors nohead linestyle 9 linewidth 2 title "
             "'mean', $wave using 1:3 with lines linestyle 1 title 'i_A', "
             "$samples using 1:2 with points linestyle 2 title 'valley sample', "
             "$samples using 3:4 with points linestyle 3 title 'peak sample'\nunset multiplot\n");
    page_heading(p, 3, "Switching and sampling at 8000 rpm");
    return page_figure(
        p, &drawing, "2019-figure-3",
        "Figure 3. PWM signals, voltage and current of phase A at 8000 rpm (12.5 switching periods a "
        "fundamental period). The mid-point sample misses the cycle's mean by what the current bends.",
        e);
}

/* ---- Fig. 6 ---- */

static bool figure_6(page *p, const comparison *c, const method_machine *machine, const steady_drive *d,
                     error *e)
{
    enum { SHOWN = 50 };
    plot drawing;
    if (!plot_begin(&drawing, 620, 560, e)) {
        return false;
    }
    plot_data(&drawing, "errors");
    for (int n = 0; n <= SHOWN; n++) {
        const method_input in = method_input_of(d, &d->cycle[n]);
        plot_say(&drawing, "%.7g %.6g", 1e3 * n * d->T_s, creal(d->cycle[n].i_valley_A));
        for (int k = 0; k < METHOD_COUNT; k++) {
            const double complex off =
                method_compute((method)k, machine, &in) - method_truth((method)k, &d->cycle[n]);
            plot_say(&drawing, " %.6g", creal(off));
        }
        plot_say(&drawing, "\n");
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set multiplot\nset lmargin at screen 0.13\nset rmargin at screen 0.985\n"
             "set xrange [0:%g]\nset format x ''\n"
             "set key top right horizontal font ',11'\nset offsets 0,0,graph 0.32,graph 0.05\n"
             "set tmargin at screen 0.985\nset bmargin at screen 0.74\nset ylabel 'i_A, A'\n"
             "plot $errors using 1:2 with steps linestyle 9 title 'sampled phase current'\n"
             "set tmargin at screen 0.69\nset bmargin at screen 0.42\nset ylabel 'error of the mean, A'\n"
             "plot $errors using 1:3 with steps linestyle 1 title 'standard', "
             "$errors using 1:4 with steps linestyle 2 title 'quasi-discrete'\n"
             "set tmargin at screen 0.37\nset bmargin at screen 0.1\n"
             "set ylabel 'error of prediction, A'\nset format x '%%g'\nset xlabel 't, ms'\n"
             "plot $errors using 1:5 with steps linestyle 1 title 'standard', "
             "$errors using 1:6 with steps linestyle 2 title 'quasi-discrete'\nunset multiplot\n",
             1e3 * SHOWN * d->T_s);
    page_heading(p, 3, "Errors over time");
    return rows_page_figure(p, &drawing, "2019-figure-6",
                            "Figure 6. Errors of mean current and prediction of phase A at 8000 rpm, rated "
                            "current, four fundamental periods.",
                            c, "2019", "Figure 6", NULL, e);
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

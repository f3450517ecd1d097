/* 2016: Figs. 8 and 9 (the analysis as contours), 12 (waveforms), 13-15 (the three motors). */
#include "../report/contour.h"
#include "discrete_angle.h"
#include "figures.h"
#include "paper_2016.h"
#include "rows_page.h"

#include <math.h>

/* ---- Figs. 8 and 9: contours ---- */

static double complex normalised(double k, double gamma_deg)
{
    return papers_mean_normalised((papers_movement){k, gamma_deg * VEC_PI / 180.0, VEC_PI / 3.0});
}

static double mean_d(double k, double gamma_deg)
{
    return creal(normalised(k, gamma_deg));
}

static double mean_q(double k, double gamma_deg)
{
    return cimag(normalised(k, gamma_deg));
}

/*
 * Fig. 9's axes are what the rotor sees, not k and gamma: a current that changes by dm in modulus and da in
 * angle while the rotor turns by pi/3. Seen standing still it turns by b = da + pi/3 from modulus m to m +
 * dm, and its mean has modulus 1: |m + (m + dm) e^{jb}| = 2, that is m^2 + m dm + (dm^2 - 4)/(2 (1 + cos b))
 * = 0.
 */
static double complex mean_of_change(double dm, double da_rad)
{
    const double b = da_rad + VEC_PI / 3.0;
    const double m = -0.5 * dm + sqrt(0.25 * dm * dm - (dm * dm - 4.0) / (2.0 * (1.0 + cos(b))));
    return papers_mean_normalised(papers_movement_of(m, (m + dm) * vec_turn(b), VEC_PI / 3.0));
}

static double gain_percent(double dm, double da_rad)
{
    return 100.0 * papers_error_of(mean_of_change(dm, da_rad)).gain;
}

static double phase_mrad(double dm, double da_rad)
{
    return 1000.0 * papers_error_of(mean_of_change(dm, da_rad)).phase_rad;
}

static bool figures_8_and_9(page *p, const comparison *c, error *e)
{
    static const contour_panel figure_8[2] = {{"(a) d' component, p.u.", "k", "γ, degrees", 0, 2, -90, 90,
                                               0.92, 0.02, 1.2, "%.2f", 0, 0, 2, 0, mean_d},
                                              {"(b) q' component, p.u.", "k", "γ, degrees", 0, 2, -90, 90,
                                               -0.2, 0.02, 0.2, "%.2f", 1.5, -90, 1.5, 90, mean_q}};
    static const contour_panel figure_9[2] = {
        {"(a) gain error, %", "change of modulus, p.u.", "change of angle, rad", -0.6, 0.6, -0.6, 0.6, -4, 1,
         16, "%.0f", 0, -0.6, 0, 0.6, gain_percent},
        {"(b) phase error, mrad", "change of modulus, p.u.", "change of angle, rad", -0.6, 0.6, -0.6, 0.6,
         -100, 10, 100, "%.0f", -0.6, 0, 0.6, 0, phase_mrad}};
    page_heading(p, 3, "What the discrete angle gets wrong");
    plot drawing;
    page_pair_begin(p);
    if (!contour_pair(&drawing, figure_8, e) ||
        !page_figure(p, &drawing, "2016-figure-8",
                     "Figure 8. True mean current relative to the discrete angle's, which is 1 + j0 by the "
                     "normalisation, over the current's movement k, γ (Θ = π/3).",
                     e)) {
        return false;
    }
    page_pair_beside(p);
    page_text(p, "In steady state k = 1 and γ = 0; the mean is 6√3/π² there.");
    rows_page_table(p, c, "2016", "eq. (9)", NULL);
    page_pair_end(p);
    return contour_pair(&drawing, figure_9, e) &&
           rows_page_figure(
               p, &drawing, "2016-figure-9",
               "Figure 9. The same as errors of gain and phase, over the change of the current as the rotor "
               "sees it. The middle is the steady state.",
               c, "2016", "Section 5.3", NULL, e);
}

/* ---- Fig. 12: waveforms ---- */

static const char *const phase_names[3] = {"A", "B", "C"};

static void say_waveforms(plot *p, const six_step_run *run, size_t intervals)
{
    enum { STEPS = 12 };
    plot_data(p, "wave");
    for (size_t n = 0; n < intervals; n++) {
        const six_step_interval *at = &run->interval[n];
        for (int step = 0; step <= STEPS; step++) {
            const double t_s = at->duration_s * step / STEPS;
            plot_say(p, "%.6g", 1e3 * (at->t_s + t_s));
            for (int x = 0; x < 3; x++) {
                /* The star point floats: phase voltages are those of the vector (2/3) u_dc e^{jn pi/3}. */
                plot_say(p, " %.6g",
                         vec_phase(vec_ab_of(2.0 / 3.0 * vec_turn(at->vector * VEC_PI / 3.0)), x));
            }
            for (int x = 0; x < 3; x++) {
                plot_say(p, " %.6g", vec_phase(vec_ab_of(six_step_current(run, at, t_s)), x));
            }
            plot_say(p, "\n");
        }
    }
    plot_data_end(p);
}

static bool figure_12(page *p, error *e)
{
    const six_step_scenario test = paper_2016_scenario(&paper_2016_motors[1]);
    six_step_run run;
    plot drawing;
    if (!six_step_solve(&test, &run, e)) {
        return false;
    }
    if (!plot_begin(&drawing, 620, 420, e)) {
        six_step_free(&run);
        return false;
    }
    say_waveforms(&drawing, &run, 12);
    six_step_free(&run);
    plot_say(&drawing, "set multiplot\nset lmargin at screen 0.12\nset rmargin at screen 0.985\n"
                       "set yrange [-0.8:0.8]\n"
                       "set ytics ('−2/3' -0.667, '0' 0, '2/3' 0.667)\nset format x ''\n"
                       "set xrange [0:*] noextend\n");
    for (int x = 0; x < 3; x++) {
        plot_say(&drawing,
                 "set tmargin at screen %g\nset bmargin at screen %g\n"
                 "set ylabel 'u_%s / u_{dc}' offset 0.6,0\n"
                 "plot $wave using 1:%d with lines linestyle %d notitle\n",
                 0.98 - 0.155 * x, 0.85 - 0.155 * x, phase_names[x], 2 + x, 1 + x);
    }
    plot_say(&drawing, "set tmargin at screen 0.5\nset bmargin at screen 0.12\nset format x '%%g'\n"
                       "set ytics auto\nset yrange [*:*]\nset xlabel 't, ms'\nset ylabel 'i, p.u.'\n"
                       "set key at graph 0.99,1.12 horizontal\nplot");
    for (int x = 0; x < 3; x++) {
        plot_say(&drawing, "%s $wave using 1:%d with lines linestyle %d title 'i_%s'", x > 0 ? "," : "",
                 5 + x, 1 + x, phase_names[x]);
    }
    plot_say(&drawing, "\nunset multiplot\n");
    page_heading(p, 3, "The six-step drive");
    return page_figure(p, &drawing, "2016-figure-12",
                       "Figure 12. Phase voltages and currents in steady six-step operation, motor 2, "
                       "two periods at 105 Hz. Current relative to the modulus of its mean.",
                       e);
}

/* ---- Figs. 13-15 ---- */

static void say_errors(plot *p, const six_step_run *run)
{
    plot_data(p, "errors");
    for (size_t n = 0; n < run->count; n++) {
        const six_step_interval *at = &run->interval[n];
        const discrete_angle d = discrete_angle_of(at);
        plot_say(p, "%.8g %.6g %.6g %.8g %.8g %.8g %.8g %.6g %.6g\n", at->t_s + 0.5 * at->duration_s,
                 d.change.modulus, d.change.angle_rad, 100.0 * d.path_a.gain, 100.0 * d.path_bc.gain,
                 1e3 * d.path_a.phase_rad, 1e3 * d.path_bc.phase_rad, 1e3 * (d.path_a.gain - d.path_bc.gain),
                 1e3 * (d.path_a.phase_rad - d.path_bc.phase_rad));
    }
    plot_data_end(p);
    plot_data(p, "reference");
    plot_say(p, "0 0\n%.8g 0\n%.8g %.8g\n0.3 %.8g\n", run->t_step_s, run->t_step_s, VEC_PI / 6.0,
             VEC_PI / 6.0);
    plot_data_end(p);
}

/* Five panels, one above the other, with one axis of time. */
static void say_panels(plot *p)
{
    static const struct {
        const char *label, *ticks, *curves;
    } panels[5] = {{"(a) reference,\\nrad", "0.25", "$reference using 1:2 with lines linestyle 1 notitle"},
                   {"(b) change per\\ninterval", "0.4",
                    "$errors using 1:2 with lines linestyle 1 title 'modulus, p.u.', $errors using 1:3 "
                    "with lines linestyle 2 title 'angle, rad'"},
                   {"(c) gain error,\\n%", "4",
                    "$errors using 1:4 with lines linestyle 1 title 'analytical (A)', $errors using 1:5 "
                    "with points linestyle 2 pointsize 0.3 title 'numerical (B/C)'"},
                   {"(d) phase error,\\nmrad", "40",
                    "$errors using 1:6 with lines linestyle 1 title 'analytical (A)', $errors using 1:7 "
                    "with points linestyle 2 pointsize 0.3 title 'numerical (B/C)'"},
                   {"(e) A − B/C,\\n10^{−3}", "autofreq",
                    "$errors using 1:8 with lines linestyle 1 title 'gain, p.u.', $errors using 1:9 with "
                    "lines linestyle 2 title 'phase, rad'"}};
    plot_say(p, "set multiplot\nset lmargin at screen 0.15\nset rmargin at screen 0.985\n"
                "set xrange [0:0.3]\nset format x ''\nset key top right horizontal samplen 1.5 font ',11'\n"
                "set offsets 0,0,graph 0.3,graph 0.08\nset ytics autofreq\n");
    for (int n = 0; n < 5; n++) {
        const double top = 0.985 - 0.187 * n;
        plot_say(p,
                 "set tmargin at screen %g\nset bmargin at screen %g\nset ylabel \"%s\"\nset ytics %s\n"
                 "%splot %s\n",
                 top, top - 0.165, panels[n].label, panels[n].ticks,
                 n == 4 ? "set format x '%g'\nset xlabel 't, s'\n" : "", panels[n].curves);
    }
    plot_say(p, "unset multiplot\n");
}

static bool figure_of_motor(page *p, const comparison *c, int which, error *e)
{
    const paper_2016_motor *m = &paper_2016_motors[which];
    const six_step_scenario test = paper_2016_scenario(m);
    six_step_run run;
    plot drawing;
    char id[32];
    char caption[256];
    if (!six_step_solve(&test, &run, e)) {
        return false;
    }
    if (!plot_begin(&drawing, 620, 720, e)) {
        six_step_free(&run);
        return false;
    }
    say_errors(&drawing, &run);
    six_step_free(&run);
    say_panels(&drawing);
    snprintf(id, sizeof id, "2016-figure-%d", 13 + which);
    snprintf(caption, sizeof caption,
             "Figure %d. Motor %d (L = %g mH, R = %g mΩ, τ = L/R = %.3g ms): the reference angle steps "
             "by π/6 at 0.1 s. One point a control interval.",
             13 + which, 1 + which, 1e3 * m->L_H, 1e3 * m->R_ohm, 1e3 * m->L_H / m->R_ohm);
    return rows_page_figure(p, &drawing, id, caption, c, "2016", "Table 2", m->name, e);
}

bool figures_2016(page *p, const comparison *c, error *e)
{
    page_heading(p, 2, "2016: rotor position discretised, six-step");
    page_text(p, "Averaging phase currents and turning the mean by one angle is wrong when the rotor "
                 "turns by π/3 within a control interval. Path A is the paper's analysis, from the "
                 "current at both ends of the interval; paths B and C are the true mean and the discrete "
                 "angle's, in closed form here.");
    if (!figures_8_and_9(p, c, e) || !figure_12(p, e)) {
        return false;
    }
    page_heading(p, 3, "Steady state and a step, three motors");
    for (int n = 0; n < PAPER_2016_MOTORS; n++) {
        if (!figure_of_motor(p, c, n, e)) {
            return false;
        }
    }
    return true;
}

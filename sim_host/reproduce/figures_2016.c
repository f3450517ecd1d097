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
    page_heading(p, 3, "The error of the discrete angle");
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

enum { WAVE_T, WAVE_U, WAVE_I = WAVE_U + 3, WAVE_COLUMNS = WAVE_I + 3 };

static chart_data waveforms_of(const six_step_run *run, size_t intervals)
{
    enum { STEPS = 12 };
    chart_data d = chart_data_of(WAVE_COLUMNS);
    for (size_t n = 0; n < intervals; n++) {
        const six_step_interval *at = &run->interval[n];
        for (int step = 0; step <= STEPS; step++) {
            const double t_s = at->duration_s * step / STEPS;
            double row[WAVE_COLUMNS] = {[WAVE_T] = 1e3 * (at->t_s + t_s)};
            for (int x = 0; x < 3; x++) {
                /* The star point floats: phase voltages are those of the vector (2/3) u_dc e^{jn pi/3}. */
                row[WAVE_U + x] = vec_phase(vec_ab_of(2.0 / 3.0 * vec_turn(at->vector * VEC_PI / 3.0)), x);
                row[WAVE_I + x] = vec_phase(vec_ab_of(six_step_current(run, at, t_s)), x);
            }
            chart_data_add(&d, row);
        }
    }
    return d;
}

static bool figure_12(page *p, error *e)
{
    enum { PANELS = 4 };
    static const char *const voltage[3] = {"u_A / u_dc", "u_B / u_dc", "u_C / u_dc"};
    static const char *const current[3] = {"i_A", "i_B", "i_C"};
    const six_step_scenario test = paper_2016_scenario(&paper_2016_motors[1]);
    six_step_run run;
    chart drawn[PANELS];
    if (!six_step_solve(&test, &run, e)) {
        return false;
    }
    chart_data d = waveforms_of(&run, 12);
    six_step_free(&run);
    drawn[3] = (chart){.x_label = "t, ms", .y_label = "i, p.u.", .group = "2016-12", .height = 230};
    for (size_t x = 0; x < 3; x++) {
        const chart_colour colour = (chart_colour)x;
        drawn[x] = (chart){.x_label = "t, ms",
                           .y_label = voltage[x],
                           .group = "2016-12",
                           .y = {.fixed = true, .low = -0.8, .high = 0.8},
                           .height = 130};
        drawn[x].series[0] =
            (chart_series){voltage[x], &d, WAVE_U + x, colour, CHART_LINE, CHART_ALWAYS, 0.0, false};
        drawn[3].series[x] =
            (chart_series){current[x], &d, WAVE_I + x, colour, CHART_LINE, CHART_ALWAYS, 0.0, false};
    }
    page_heading(p, 3, "The six-step drive");
    const bool ok =
        page_charts(p, drawn, PANELS, "2016-figure-12",
                    "Figure 12. Phase voltages and currents in steady six-step operation, motor 2, "
                    "two periods at 105 Hz. Current relative to the modulus of its mean.",
                    e);
    chart_data_free(&d);
    return ok;
}

/* ---- Figs. 13-15 ---- */

enum {
    ERROR_T,
    ERROR_MODULUS,
    ERROR_ANGLE,
    ERROR_GAIN_A,
    ERROR_GAIN_BC,
    ERROR_PHASE_A,
    ERROR_PHASE_BC,
    ERROR_GAINS,
    ERROR_PHASES,
    ERROR_COLUMNS
};

static chart_data errors_of(const six_step_run *run)
{
    chart_data d = chart_data_of(ERROR_COLUMNS);
    for (size_t n = 0; n < run->count; n++) {
        const six_step_interval *at = &run->interval[n];
        const discrete_angle a = discrete_angle_of(at);
        chart_data_add(&d, (double[ERROR_COLUMNS]){
                               at->t_s + 0.5 * at->duration_s, a.change.modulus, a.change.angle_rad,
                               100.0 * a.path_a.gain, 100.0 * a.path_bc.gain, 1e3 * a.path_a.phase_rad,
                               1e3 * a.path_bc.phase_rad, 1e3 * (a.path_a.gain - a.path_bc.gain),
                               1e3 * (a.path_a.phase_rad - a.path_bc.phase_rad)});
    }
    return d;
}

/* Up to two curves of a panel. */
typedef struct error_panel {
    const char *y_label, *first, *second;
    size_t column;
    chart_mark mark; /* of the second */
} error_panel;

static bool draw_errors(page *p, const chart_data *errors, const chart_data *reference, const char *id,
                        const char *caption, const comparison *c, const char *motor_name, error *e)
{
    enum { PANELS = 5 };
    static const error_panel panels[PANELS] = {
        {"(a) reference, rad", "reference", NULL, 1, CHART_LINE},
        {"(b) change, interval", "modulus, p.u.", "angle, rad", ERROR_MODULUS, CHART_LINE},
        {"(c) gain error, %", "analytical (A)", "numerical (B/C)", ERROR_GAIN_A, CHART_POINTS},
        {"(d) phase error, mrad", "analytical (A)", "numerical (B/C)", ERROR_PHASE_A, CHART_POINTS},
        {"(e) A − B/C, 1e-3", "gain, p.u.", "phase, rad", ERROR_GAINS, CHART_LINE}};
    chart drawn[PANELS];
    for (size_t n = 0; n < PANELS; n++) {
        const error_panel *at = &panels[n];
        const chart_data *d = n == 0 ? reference : errors;
        drawn[n] = (chart){
            .x_label = "t, s",
            .y_label = at->y_label,
            .group = id,
            .height = 180,
            .x = {.fixed = true, .low = 0.0, .high = 0.3},
            .series = {{at->first, d, at->column, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false},
                       {at->second, d, at->column + 1, CHART_ORANGE, at->mark, CHART_ALWAYS, 0.0, false}}};
    }
    return rows_page_charts(p, drawn, PANELS, id, caption, c, "2016", "Table 2", motor_name, e);
}

static bool figure_of_motor(page *p, const comparison *c, int which, error *e)
{
    const paper_2016_motor *m = &paper_2016_motors[which];
    const six_step_scenario test = paper_2016_scenario(m);
    six_step_run run;
    char id[32];
    char caption[256];
    if (!six_step_solve(&test, &run, e)) {
        return false;
    }
    chart_data errors = errors_of(&run);
    chart_data reference = chart_data_of(2);
    chart_data_add(&reference, (double[]){0.0, 0.0});
    chart_data_add(&reference, (double[]){run.t_step_s, 0.0});
    chart_data_add(&reference, (double[]){run.t_step_s, VEC_PI / 6.0});
    chart_data_add(&reference, (double[]){0.3, VEC_PI / 6.0});
    six_step_free(&run);
    snprintf(id, sizeof id, "2016-figure-%d", 13 + which);
    snprintf(caption, sizeof caption,
             "Figure %d. Motor %d (L = %g mH, R = %g mΩ, τ = L/R = %.3g ms): the reference angle steps "
             "by π/6 at 0.1 s. One point a control interval.",
             13 + which, 1 + which, 1e3 * m->L_H, 1e3 * m->R_ohm, 1e3 * m->L_H / m->R_ohm);
    const bool ok = draw_errors(p, &errors, &reference, id, caption, c, m->name, e);
    chart_data_free(&errors);
    chart_data_free(&reference);
    return ok;
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

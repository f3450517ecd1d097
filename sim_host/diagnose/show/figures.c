/* Figures over time, and over what a residual may depend on. */
#include "figures.h"

#include <math.h>

/* Fewer samples say nothing about a bin's mean. */
enum { LEAST_COUNT = 24 };

/* Two electrical revolutions in one stretch. */
static bool rotor_turns(const recording *rec)
{
    for (size_t n = 0; n < rec->stretches; n++) {
        double angle = 0.0;
        for (size_t k = rec->stretch[n].first; k < rec->stretch[n].first + rec->stretch[n].count; k++) {
            angle += rec->omega_e_rad_s[k] * rec->T_s;
        }
        if (fabs(angle) > 4.0 * VEC_PI) {
            return true;
        }
    }
    return false;
}

evidence evidence_of(const recording *rec, const motor *nominal, const diagnosis *d,
                     const plant_witness *witness)
{
    const averaged_drive *drive = &d->extended_drive;
    evidence v = {.rec = rec,
                  .nominal = nominal,
                  .d = d,
                  .witness = witness,
                  .extended = d->causes > 0,
                  .was = d->causes > 0 ? "as it was" : "model"};
    v.turns = rotor_turns(rec);
    v.before = (residual){rec, d->error_nominal, drive->L_d_H, drive->L_q_H};
    v.after = (residual){rec, d->error_extended, drive->L_d_H, drive->L_q_H};
    if (witness->simulated) {
        v.plant = (residual){&witness->rec, witness->found.error_nominal, drive->L_d_H, drive->L_q_H};
    }
    return v;
}

/* ---- Over time ---- */

typedef struct window {
    size_t first, count;
    const diagnosis_run *run;
} window;

/* A run none of whose rows was held out has no such error. */
static double beyond_noise(const diagnosis_run *run)
{
    return isfinite(run->nominal) ? run->nominal - run->noise_floor : -INFINITY;
}

/* Some periods of the run in which the nominal model errs most beyond its noise. */
static window choose_window(const evidence *v)
{
    const diagnosis *d = v->d;
    const diagnosis_run *worst = &d->run[0];
    for (size_t k = 1; k < d->runs; k++) {
        if (beyond_noise(&d->run[k]) > beyond_noise(worst)) {
            worst = &d->run[k];
        }
    }
    const stretch *longest = &v->rec->stretch[0];
    for (size_t n = 0; n < v->rec->stretches; n++) {
        const stretch *s = &v->rec->stretch[n];
        if (s->run == worst->run && (longest->run != worst->run || s->count > longest->count)) {
            longest = s;
        }
    }
    const double turn_rows = 2.0 * VEC_PI / fmax(fabs(worst->omega_rad_s) * v->rec->T_s, 1e-3);
    window w = {longest->first + longest->count / 4, (size_t)fmin(fmax(4.0 * turn_rows, 80.0), 400.0), worst};
    if (w.first + w.count > longest->first + longest->count) {
        w.count = longest->first + longest->count - w.first;
    }
    return w;
}

static void say_number(plot *drawing, double x)
{
    if (isfinite(x)) {
        plot_say(drawing, " %.6g", x);
    } else {
        plot_say(drawing, " NaN");
    }
}

static void say_window(plot *drawing, const evidence *v, const window *w)
{
    plot_data(drawing, "rows");
    for (size_t k = w->first; k < w->first + w->count; k++) {
        residual_point before = {.theta_rad = 0.0};
        residual_point after = {.theta_rad = 0.0};
        const bool seen = residual_at(&v->before, k, &before) && residual_at(&v->after, k, &after);
        plot_say(drawing, "%.7g", 1e3 * (v->rec->t_s[k] - v->rec->t_s[w->first]));
        say_number(drawing, recording_current(v->rec, k).alpha);
        say_number(drawing, v->d->free_nominal[k].alpha);
        say_number(drawing, v->d->free_extended[k].alpha);
        say_number(drawing, seen ? before.v_phase_V[0] : NAN);
        say_number(drawing, seen ? after.v_phase_V[0] : NAN);
        plot_say(drawing, "\n");
    }
    plot_data_end(drawing);
}

bool figure_waveform(page *p, const evidence *v, error *e)
{
    plot drawing;
    const window w = choose_window(v);
    char caption[400];
    if (!plot_begin(&drawing, 560, 430, e)) {
        return false;
    }
    say_window(&drawing, v, &w);
    plot_say(&drawing,
             "set multiplot\nset lmargin at screen 0.15\nset rmargin at screen 0.985\nset format x ''\n"
             "set key at graph 1,1.17 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset xrange "
             "[0:*] noextend\n"
             "set tmargin at screen 0.92\nset bmargin at screen 0.5\nset ylabel 'phase A, A'\n"
             "plot $rows using 1:2 with lines linestyle 9 linewidth 4 title 'measured', "
             "$rows using 1:3 with lines linestyle 2 title '%s'",
             v->was);
    if (v->extended) {
        plot_say(&drawing, ", $rows using 1:4 with lines linestyle 1 title 'extended'");
    }
    plot_say(
        &drawing,
        "\nunset key\nset tmargin at screen 0.44\nset bmargin at screen 0.12\nset format x '%%g'\nset xlabel "
        "'time, "
        "ms'\nset ylabel 'difference, A'\nplot $rows using 1:($2-$3) with lines linestyle 2 notitle");
    if (v->extended) {
        plot_say(&drawing, ", $rows using 1:($2-$4) with lines linestyle 1 notitle");
    }
    plot_say(&drawing, "\nunset multiplot\n");
    snprintf(caption, sizeof caption,
             "Free run, started once at the beginning of the stretch and fed with the recorded voltages and "
             "angles only: run %ld, "
             "%.0f rad/s (electrical), where the model errs most.",
             w.run->run, w.run->omega_rad_s);
    return page_figure(p, &drawing, "waveform", caption, e);
}

bool figure_residual_time(page *p, const evidence *v, error *e)
{
    plot drawing;
    const window w = choose_window(v);
    if (!plot_begin(&drawing, 560, 430, e)) {
        return false;
    }
    say_window(&drawing, v, &w);
    plot_say(&drawing,
             "set xrange [0:*] noextend\nset xlabel 'time, ms'\nset ylabel 'missing voltage of phase A, V'\n"
             "set key at graph 1,1.09 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset "
             "tmargin 2.5\n"
             "plot $rows using 1:5 with steps linestyle 2 title '%s'",
             v->was);
    if (v->extended) {
        plot_say(&drawing, ", $rows using 1:6 with steps linestyle 1 title 'extended'");
    }
    plot_say(&drawing, "\n");
    return page_figure(p, &drawing, "residual-time",
                       "What one-cycle prediction lacks, as a voltage: L (measured - predicted)/T, the same "
                       "stretch of time.",
                       e);
}

/* ---- Over angle, speed, current, voltage ---- */

static void say_bins(plot *drawing, const char *name, const residual *r, residual_axis axis, double low,
                     double high)
{
    residual_bin bins[RESIDUAL_BINS];
    residual_bins(r, axis, low, high, bins);
    plot_data(drawing, name);
    for (size_t n = 0; n < RESIDUAL_BINS; n++) {
        if (bins[n].count >= LEAST_COUNT) {
            plot_say(drawing, "%.6g %.6g\n", bins[n].x, bins[n].y);
        }
    }
    plot_data_end(drawing);
}

/* Root mean square of what the extended model leaves, a phase: noise, where it explains all. */
static double rest(const evidence *v)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t k = 1; k < v->rec->rows; k++) {
        residual_point p;
        if (residual_at(&v->after, k, &p)) {
            sum += 0.5 * (p.v_V.alpha * p.v_V.alpha + p.v_V.beta * p.v_V.beta);
            n += 1.0;
        }
    }
    return n > 0.0 ? sqrt(sum / n) : 1.0;
}

/* The largest recorded |value| that an axis shows. */
static double reach(const evidence *v, residual_axis axis)
{
    double most = 1e-9;
    for (size_t k = 1; k < v->rec->rows; k++) {
        residual_point p;
        if (!residual_at(&v->before, k, &p)) {
            continue;
        }
        for (int x = 0; x < 3; x++) {
            const double at = axis == AXIS_CURRENT ? p.i_phase_A[x]
                                                   : (axis == AXIS_VOLTAGE ? p.u_phase_V[x] : p.omega_rad_s);
            most = fmax(most, fabs(at));
        }
    }
    return 1.001 * most;
}

static bool figure_bins(page *p, const evidence *v, residual_axis axis, double low, double high,
                        const char *labels, const char *id, const char *caption, error *e)
{
    plot drawing;
    const char *style = axis == AXIS_SPEED ? "points" : "linespoints";
    char range[64];
    /* Means of noise are not blown up to the figure's height. */
    snprintf(range, sizeof range, "set yrange [*<%.3g:%.3g<*];", -0.5 * rest(v), 0.5 * rest(v));
    if (!plot_begin(&drawing, 560, 380, e)) {
        return false;
    }
    say_bins(&drawing, "before", &v->before, axis, low, high);
    say_bins(&drawing, "after", &v->after, axis, low, high);
    plot_say(&drawing,
             "%s\nset key at graph 1,1.11 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset "
             "tmargin 2.5\nset "
             "xrange [%g:%g]\n"
             "%s plot $before using 1:2 with %s linestyle 2 title '%s'",
             labels, low, high, axis == AXIS_SPEED ? "" : range, style, v->was);
    if (v->extended) {
        plot_say(&drawing, ", $after using 1:2 with %s linestyle 1 title 'extended'", style);
    }
    plot_say(&drawing, "\n");
    return page_figure(p, &drawing, id, caption, e);
}

bool figure_current(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_CURRENT);
    return figure_bins(p, v, AXIS_CURRENT, -most, most,
                       "set xlabel 'phase current, A'\nset ylabel 'missing phase voltage (mean), V'",
                       "residual-current",
                       "Against the phase's own current, all phases together. A voltage lost against the "
                       "current's sign is a step, a "
                       "resistance a slope.",
                       e);
}

bool figure_voltage(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_VOLTAGE);
    return figure_bins(
        p, v, AXIS_VOLTAGE, -most, most,
        "set xlabel 'commanded phase voltage, V'\nset ylabel 'missing phase voltage (mean), V'",
        "residual-voltage", "Against the commanded voltage. A wrong DC link or modulator gain is a slope.",
        e);
}

bool figure_speed(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_SPEED);
    return figure_bins(
        p, v, AXIS_SPEED, -most, most,
        "set xlabel 'electrical speed, rad/s'\nset ylabel 'missing voltage (rms), V'\nset yrange [0:*]",
        "residual-speed",
        "Against speed. What grows with it is in flux, inductance or angle; what does not, in resistance, "
        "dead time or "
        "sensors.",
        e);
}

bool figure_angle(page *p, const evidence *v, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 560, 380, e)) {
        return false;
    }
    say_bins(&drawing, "before", &v->before, AXIS_ANGLE, 0.0, 2.0 * VEC_PI);
    say_bins(&drawing, "after", &v->after, AXIS_ANGLE, 0.0, 2.0 * VEC_PI);
    plot_say(&drawing,
             "set xlabel 'electrical rotor angle, degrees'\nset ylabel 'missing voltage (rms), V'\nset "
             "xrange [0:360]\n"
             "set xtics 60\nset yrange [0:*]\nset key at graph 1,1.11 right horizontal maxrows 1 samplen "
             "1.2\nset tmargin "
             "2.5\nplot $before using ($1*180/pi):2 with linespoints linestyle 2 title '%s'",
             v->was);
    if (v->extended) {
        plot_say(&drawing, ", $after using ($1*180/pi):2 with linespoints linestyle 1 title 'extended'");
    }
    plot_say(&drawing, "\n");
    return page_figure(p, &drawing, "residual-angle",
                       "Against the rotor's angle: length of the missing voltage vector, all runs.", e);
}

bool figure_plant_current(page *p, const evidence *v, error *e)
{
    plot drawing;
    const double most = reach(v, AXIS_CURRENT);
    if (!plot_begin(&drawing, 560, 380, e)) {
        return false;
    }
    say_bins(&drawing, "machine", &v->before, AXIS_CURRENT, -most, most);
    say_bins(&drawing, "plant", &v->plant, AXIS_CURRENT, -most, most);
    plot_say(
        &drawing,
        "set xlabel 'phase current, A'\nset ylabel 'missing phase voltage (mean), V'\nset xrange [%g:%g]\n"
        "set key at graph 1,1.11 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset tmargin "
        "2.5\n"
        "plot $machine using 1:2 with lines linestyle 9 linewidth 4 title 'machine', "
        "$plant using 1:2 with linespoints linestyle 4 title 'plant'\n",
        -most, most);
    return page_figure(
        p, &drawing, "plant-current",
        "The model as it was, on the machine and on the plant: missing voltage against phase current.", e);
}

/* The whole recording over time; the first view is the run with the largest error beyond noise (figures.h). */
#include "figures.h"

#include <math.h>

typedef struct window {
    size_t first, count;
    const diagnosis_run *run;
} window;

/* A run without held-out rows has no error. */
static double beyond_noise(const diagnosis_run *run)
{
    return isfinite(run->nominal) ? run->nominal - run->noise_floor : -INFINITY;
}

/* A few periods of the run with the largest error beyond noise. */
static window choose_window(const report_context *c)
{
    const diagnosis *d = c->d;
    const diagnosis_run *worst = &d->run[0];
    for (size_t k = 1; k < d->runs; k++) {
        if (beyond_noise(&d->run[k]) > beyond_noise(worst)) {
            worst = &d->run[k];
        }
    }
    const stretch *longest = &c->rec->stretch[0];
    for (size_t n = 0; n < c->rec->stretches; n++) {
        const stretch *s = &c->rec->stretch[n];
        if (s->run == worst->run && (longest->run != worst->run || s->count > longest->count)) {
            longest = s;
        }
    }
    const double turn_rows = 2.0 * VEC_PI / fmax(fabs(worst->omega_rad_s) * c->rec->T_s, 1e-3);
    window w = {longest->first + longest->count / 4, (size_t)fmin(fmax(4.0 * turn_rows, 80.0), 400.0), worst};
    if (w.first + w.count > longest->first + longest->count) {
        w.count = longest->first + longest->count - w.first;
    }
    return w;
}

/* ---- The recording's rows ---- */

enum {
    TIME,
    MEASURED,
    FREE_NOMINAL,
    FREE_EXTENDED,
    OFF_NOMINAL,
    OFF_EXTENDED,
    LACKS_NOMINAL,
    LACKS_EXTENDED,
    SPEED,
    COLUMNS
};

static void add_row(chart_data *d, const report_context *c, size_t k, double t_s)
{
    residual_point before = {.theta_rad = 0.0};
    residual_point after = {.theta_rad = 0.0};
    const bool seen = residual_at(&c->before, k, &before) && residual_at(&c->after, k, &after);
    const double measured = recording_current(c->rec, k).alpha;
    const double nominal = c->d->free_nominal[k].alpha;
    const double extended = c->d->free_extended[k].alpha;
    chart_data_add(d, (double[COLUMNS]){[TIME] = t_s,
                                        [MEASURED] = measured,
                                        [FREE_NOMINAL] = nominal,
                                        [FREE_EXTENDED] = extended,
                                        [OFF_NOMINAL] = measured - nominal,
                                        [OFF_EXTENDED] = measured - extended,
                                        [LACKS_NOMINAL] = seen ? before.v_phase_V[0] : NAN,
                                        [LACKS_EXTENDED] = seen ? after.v_phase_V[0] : NAN,
                                        [SPEED] = c->rec->omega_e_rad_s[k]});
}

/*
 * A row without values separates two stretches, so that no line joins them. A run whose clock restarts is shown after the
 * run before.
 */
static chart_data rows_of(const report_context *c, const window *w, chart *first)
{
    const recording *rec = c->rec;
    const double gap_s = 20.0 * rec->T_s;
    chart_data d = chart_data_of(COLUMNS);
    double end_s = -INFINITY;
    for (size_t n = 0; n < rec->stretches; n++) {
        const stretch *s = &rec->stretch[n];
        const double later_s =
            rec->t_s[s->first] > end_s + 1.5 * rec->T_s ? 0.0 : end_s + gap_s - rec->t_s[s->first];
        for (size_t k = s->first; k < s->first + s->count; k++) {
            end_s = rec->t_s[k] + later_s;
            add_row(&d, c, k, end_s);
            if (k == w->first) {
                first->view_low = end_s;
            }
            if (k == w->first + w->count - 1) {
                first->view_high = end_s;
            }
        }
        if (n + 1 < rec->stretches) {
            chart_data_add(&d, (double[COLUMNS]){end_s + rec->T_s, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN});
        }
    }
    return d;
}

bool figure_time(page *p, const report_context *c, error *e)
{
    enum { CHARTS = 4 };
    const window w = choose_window(c);
    chart usual = {.group = "time", .x_label = "time, s", .height = 190};
    chart_data d = rows_of(c, &w, &usual);
    chart drawn[CHARTS] = {usual, usual, usual, usual};
    drawn[0].y_label = "phase A, A";
    drawn[0].height = 260;
    drawn[0].series[0] = (chart_series){
        .label = "measured", .data = &d, .column = MEASURED, .colour = CHART_FAINT, .width = 4.0};
    drawn[0].series[1] = figure_nominal(c, &d, FREE_NOMINAL, CHART_LINE);
    drawn[0].series[2] = figure_extended(c, &d, FREE_EXTENDED, CHART_LINE);
    drawn[1].y_label = "difference, A";
    drawn[1].series[0] = figure_nominal(c, &d, OFF_NOMINAL, CHART_LINE);
    drawn[1].series[1] = figure_extended(c, &d, OFF_EXTENDED, CHART_LINE);
    drawn[2].y_label = "residual voltage, V";
    drawn[2].series[0] = figure_nominal(c, &d, LACKS_NOMINAL, CHART_STEPS);
    drawn[2].series[1] = figure_extended(c, &d, LACKS_EXTENDED, CHART_STEPS);
    drawn[3].y_label = "speed, rad/s";
    drawn[3].height = 150;
    drawn[3].series[0] =
        (chart_series){.label = "electrical speed", .data = &d, .column = SPEED, .colour = CHART_GREEN};
    char caption[600];
    snprintf(caption, sizeof caption,
             "From top: phase current, measured and in open-loop simulation (each stretch starts once and "
             "then uses "
             "only recorded voltages and angles); measured minus simulated; residual voltage L (measured - "
             "predicted)/T of the one-cycle prediction in phase A; speed. First view: run %ld at %.0f rad/s "
             "(electrical), the run with the largest error.",
             w.run->run, w.run->omega_rad_s);
    const bool ok = page_charts(p, drawn, CHARTS, "waveform", caption, e);
    chart_data_free(&d);
    return ok;
}

/* Charts over what a residual may depend on: angle, speed, current, voltage (figures.h). */
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

chart_series figure_nominal(const evidence *v, const chart_data *d, size_t column, chart_mark mark)
{
    return (chart_series){.label = v->was,
                          .data = d,
                          .column = column,
                          .colour = CHART_ORANGE,
                          .mark = mark,
                          .role = v->extended ? CHART_NOMINAL : CHART_ALWAYS};
}

chart_series figure_extended(const evidence *v, const chart_data *d, size_t column, chart_mark mark)
{
    return (chart_series){.label = v->extended ? "extended" : NULL,
                          .data = d,
                          .column = column,
                          .colour = CHART_BLUE,
                          .mark = mark,
                          .role = CHART_EXTENDED};
}

static chart_data bins_of(const residual *r, residual_axis axis, double low, double high)
{
    residual_bin bins[RESIDUAL_BINS];
    chart_data d = chart_data_of(2);
    /* Angles are shown in degrees. */
    const double unit = axis == AXIS_ANGLE ? 180.0 / VEC_PI : 1.0;
    residual_bins(r, axis, low, high, bins);
    for (size_t n = 0; n < RESIDUAL_BINS; n++) {
        if (bins[n].count >= LEAST_COUNT) {
            chart_data_add(&d, (double[]){unit * bins[n].x, bins[n].y});
        }
    }
    return d;
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

/* The chart's axes are there; its curves are the two models' residuals. */
static bool figure_bins(page *p, const evidence *v, residual_axis axis, double low, double high, chart *drawn,
                        const char *id, const char *caption, error *e)
{
    const chart_mark mark = axis == AXIS_SPEED ? CHART_POINTS : CHART_LINE_POINTS;
    chart_data before = bins_of(&v->before, axis, low, high);
    chart_data after = bins_of(&v->after, axis, low, high);
    drawn->series[0] = figure_nominal(v, &before, 1, mark);
    drawn->series[1] = figure_extended(v, &after, 1, mark);
    const bool ok = page_chart(p, drawn, id, caption, e);
    chart_data_free(&before);
    chart_data_free(&after);
    return ok;
}

bool figure_current(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_CURRENT);
    /* Means of noise are not blown up to the chart's height. */
    chart drawn = {.x_label = "phase current, A",
                   .y_label = "missing phase voltage (mean), V",
                   .x = {.fixed = true, .low = -most, .high = most},
                   .y = {.least = 0.5 * rest(v)}};
    return figure_bins(
        p, v, AXIS_CURRENT, -most, most, &drawn, "residual-current",
        "Against the phase's own current, all phases together. A voltage lost against the current's "
        "sign is a step, a resistance a slope.",
        e);
}

bool figure_voltage(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_VOLTAGE);
    chart drawn = {.x_label = "commanded phase voltage, V",
                   .y_label = "missing phase voltage (mean), V",
                   .x = {.fixed = true, .low = -most, .high = most},
                   .y = {.least = 0.5 * rest(v)}};
    return figure_bins(p, v, AXIS_VOLTAGE, -most, most, &drawn, "residual-voltage",
                       "Against the commanded voltage. A wrong DC link or modulator gain is a slope.", e);
}

bool figure_speed(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_SPEED);
    chart drawn = {.x_label = "electrical speed, rad/s",
                   .y_label = "missing voltage (rms), V",
                   .x = {.fixed = true, .low = -most, .high = most}};
    return figure_bins(p, v, AXIS_SPEED, -most, most, &drawn, "residual-speed",
                       "Against speed. What grows with it is in flux, inductance or angle; what does not, in "
                       "resistance, dead time or sensors.",
                       e);
}

bool figure_angle(page *p, const evidence *v, error *e)
{
    chart drawn = {.x_label = "electrical rotor angle, degrees",
                   .y_label = "missing voltage (rms), V",
                   .x = {.fixed = true, .low = 0.0, .high = 360.0}};
    return figure_bins(p, v, AXIS_ANGLE, 0.0, 2.0 * VEC_PI, &drawn, "residual-angle",
                       "Against the rotor's angle: length of the missing voltage vector, all runs.", e);
}

bool figure_plant_current(page *p, const evidence *v, error *e)
{
    const double most = reach(v, AXIS_CURRENT);
    chart_data machine = bins_of(&v->before, AXIS_CURRENT, -most, most);
    chart_data plant = bins_of(&v->plant, AXIS_CURRENT, -most, most);
    const chart drawn = {
        .x_label = "phase current, A",
        .y_label = "missing phase voltage (mean), V",
        .x = {.fixed = true, .low = -most, .high = most},
        .series = {{.label = "machine", .data = &machine, .column = 1, .colour = CHART_FAINT, .width = 4.0},
                   {.label = "plant",
                    .data = &plant,
                    .column = 1,
                    .colour = CHART_PURPLE,
                    .mark = CHART_LINE_POINTS}}};
    const bool ok = page_chart(
        p, &drawn, "plant-current",
        "The model as it was, on the machine and on the plant: missing voltage against phase current.", e);
    chart_data_free(&machine);
    chart_data_free(&plant);
    return ok;
}

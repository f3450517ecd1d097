/* Residuals over angle, speed, current and voltage (figures.h). */
#include "figures.h"

#include <math.h>

/* The mean of a bin with fewer samples is too noisy to show. */
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

report_context report_context_of(const recording *rec, const motor *nominal, const diagnosis *d,
                                 const forward_validation *validation, const firmware_gain *firmware)
{
    const averaged_drive *drive = &d->extended_drive;
    report_context c = {.rec = rec,
                        .nominal = nominal,
                        .d = d,
                        .validation = validation,
                        .firmware = firmware,
                        .extended = d->causes > 0};
    c.turns = rotor_turns(rec);
    c.before = (residual){rec, d->error_nominal, drive->L_d_H, drive->L_q_H};
    c.after = (residual){rec, d->error_extended, drive->L_d_H, drive->L_q_H};
    if (validation->simulated) {
        c.plant = (residual){&validation->rec, validation->found.error_nominal, drive->L_d_H, drive->L_q_H};
    }
    return c;
}

chart_series figure_nominal(const report_context *c, const chart_data *d, size_t column, chart_mark mark)
{
    return (chart_series){.label = "nominal model",
                          .data = d,
                          .column = column,
                          .colour = CHART_ORANGE,
                          .mark = mark,
                          .role = c->extended ? CHART_NOMINAL : CHART_ALWAYS};
}

chart_series figure_extended(const report_context *c, const chart_data *d, size_t column, chart_mark mark)
{
    return (chart_series){.label = c->extended ? "extended model" : NULL,
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

/* Rms residual voltage of the extended model, per phase: the noise, if the model is complete. */
static double rest(const report_context *c)
{
    double sum = 0.0;
    double n = 0.0;
    for (size_t k = 1; k < c->rec->rows; k++) {
        residual_point p;
        if (residual_at(&c->after, k, &p)) {
            sum += 0.5 * (p.v_V.alpha * p.v_V.alpha + p.v_V.beta * p.v_V.beta);
            n += 1.0;
        }
    }
    return n > 0.0 ? sqrt(sum / n) : 1.0;
}

/* The largest recorded |value| that an axis shows. */
static double reach(const report_context *c, residual_axis axis)
{
    double most = 1e-9;
    for (size_t k = 1; k < c->rec->rows; k++) {
        residual_point p;
        if (!residual_at(&c->before, k, &p)) {
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

/* Adds the curves, the residuals of both models, to a chart that has its axes. */
static bool figure_bins(page *p, const report_context *c, residual_axis axis, double low, double high,
                        chart *drawn, const char *id, const char *caption, error *e)
{
    const chart_mark mark = axis == AXIS_SPEED ? CHART_POINTS : CHART_LINE_POINTS;
    chart_data before = bins_of(&c->before, axis, low, high);
    chart_data after = bins_of(&c->after, axis, low, high);
    drawn->series[0] = figure_nominal(c, &before, 1, mark);
    drawn->series[1] = figure_extended(c, &after, 1, mark);
    const bool ok = page_chart(p, drawn, id, caption, e);
    chart_data_free(&before);
    chart_data_free(&after);
    return ok;
}

bool figure_current(page *p, const report_context *c, error *e)
{
    const double most = reach(c, AXIS_CURRENT);
    /* At least the noise, so that means of noise do not fill the height. */
    chart drawn = {.x_label = "phase current, A",
                   .y_label = "residual phase voltage (mean), V",
                   .x = {.fixed = true, .low = -most, .high = most},
                   .y = {.least = 0.5 * rest(c)}};
    return figure_bins(
        p, c, AXIS_CURRENT, -most, most, &drawn, "residual-current",
        "Residual voltage of a phase over its current, all phases. A dead time is a step at zero current, a "
        "resistance a slope.",
        e);
}

bool figure_voltage(page *p, const report_context *c, error *e)
{
    const double most = reach(c, AXIS_VOLTAGE);
    chart drawn = {.x_label = "commanded phase voltage, V",
                   .y_label = "residual phase voltage (mean), V",
                   .x = {.fixed = true, .low = -most, .high = most},
                   .y = {.least = 0.5 * rest(c)}};
    return figure_bins(
        p, c, AXIS_VOLTAGE, -most, most, &drawn, "residual-voltage",
        "Residual voltage over the commanded voltage. A wrong DC-link voltage or modulator gain is a slope.",
        e);
}

bool figure_speed(page *p, const report_context *c, error *e)
{
    const double most = reach(c, AXIS_SPEED);
    chart drawn = {.x_label = "electrical speed, rad/s",
                   .y_label = "residual voltage (rms), V",
                   .x = {.fixed = true, .low = -most, .high = most}};
    return figure_bins(
        p, c, AXIS_SPEED, -most, most, &drawn, "residual-speed",
        "Residual voltage over speed. Errors of flux, inductance or angle grow with speed; those of "
        "resistance, dead time or sensors do not.",
        e);
}

bool figure_angle(page *p, const report_context *c, error *e)
{
    chart drawn = {.x_label = "electrical rotor angle, degrees",
                   .y_label = "residual voltage (rms), V",
                   .x = {.fixed = true, .low = 0.0, .high = 360.0}};
    return figure_bins(p, c, AXIS_ANGLE, 0.0, 2.0 * VEC_PI, &drawn, "residual-angle",
                       "Length of the residual voltage vector over the rotor angle, all runs.", e);
}

bool figure_plant_current(page *p, const report_context *c, error *e)
{
    const double most = reach(c, AXIS_CURRENT);
    chart_data machine = bins_of(&c->before, AXIS_CURRENT, -most, most);
    chart_data plant = bins_of(&c->plant, AXIS_CURRENT, -most, most);
    const chart drawn = {
        .x_label = "phase current, A",
        .y_label = "residual phase voltage (mean), V",
        .x = {.fixed = true, .low = -most, .high = most},
        .series = {
            {.label = "recorded drive", .data = &machine, .column = 1, .colour = CHART_FAINT, .width = 4.0},
            {.label = "simulated drive",
             .data = &plant,
             .column = 1,
             .colour = CHART_PURPLE,
             .mark = CHART_LINE_POINTS}}};
    const bool ok = page_chart(
        p, &drawn, "plant-current",
        "Nominal model, on the recorded and on the simulated drive: residual voltage over phase current.", e);
    chart_data_free(&machine);
    chart_data_free(&plant);
    return ok;
}

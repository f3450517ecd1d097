/* Errors by run and by method, and the residual's spectrum by order (figures.h). */
#include "figures.h"

#include <math.h>

/* ---- Run by run ---- */

/* "3\n840": the run, and its speed below. */
typedef struct run_names {
    char text[DIAGNOSIS_GROUPS][40];
    const char *of[DIAGNOSIS_GROUPS];
    size_t count;
} run_names;

static double add_name(run_names *names, const diagnosis_run *run)
{
    char *text = names->text[names->count];
    snprintf(text, sizeof names->text[0], "%ld\n%.0f", run->run, nearbyint(run->omega_rad_s) + 0.0);
    names->of[names->count] = text;
    return (double)names->count++;
}

static chart over_runs(const run_names *names, const char *y_label)
{
    return (chart){.x_label = "run, and its electrical speed in rad/s",
                   .y_label = y_label,
                   .name = names->of,
                   .names = names->count,
                   .height = 290};
}

static double positive(double x)
{
    return isfinite(x) && x > 0.0 ? x : NAN;
}

bool figure_runs(page *p, const report_context *c, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(4);
    for (size_t k = 0; k < c->d->runs; k++) {
        const diagnosis_run *run = &c->d->run[k];
        chart_data_add(&d, (double[]){add_name(&names, run), positive(run->nominal), positive(run->extended),
                                      positive(run->noise_floor)});
    }
    const chart_series noise = {"noise floor", &d, 3, CHART_GREEN, CHART_POINTS, CHART_ALWAYS, 0.0, false};
    chart drawn = over_runs(&names, "one-cycle error, %");
    drawn.series[0] = figure_nominal(c, &d, 1, CHART_BARS);
    drawn.series[1] = c->extended ? figure_extended(c, &d, 2, CHART_BARS) : noise;
    drawn.series[2] = c->extended ? noise : (chart_series){.label = NULL};
    const bool ok = page_chart(
        p, &drawn, "runs",
        "One-cycle prediction on held-out rows: rms of the error divided by rms of the current.", e);
    chart_data_free(&d);
    return ok;
}

bool figure_free_runs(page *p, const report_context *c, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(3);
    for (size_t k = 0; k < c->d->runs; k++) {
        const diagnosis_run *run = &c->d->run[k];
        chart_data_add(&d, (double[]){add_name(&names, run), fmax(run->free_nominal, 1e-3),
                                      fmax(run->free_extended, 1e-3)});
    }
    chart drawn = over_runs(&names, "open-loop error, %");
    drawn.y.logarithmic = true;
    drawn.series[0] = figure_nominal(c, &d, 1, CHART_POINTS);
    drawn.series[1] = figure_extended(c, &d, 2, CHART_POINTS);
    const bool ok = page_chart(p, &drawn, "open-loop-runs",
                               "Open-loop simulation over whole stretches. Errors accumulate, so this test "
                               "is harder. Logarithmic scale.",
                               e);
    chart_data_free(&d);
    return ok;
}

bool figure_plant_runs(page *p, const report_context *c, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(3);
    for (size_t k = 0; k < c->d->runs; k++) {
        const diagnosis_run *run = &c->d->run[k];
        const diagnosis_run *simulated = forward_validation_run(c->validation, c->d, k);
        if (simulated != NULL && run->nominal > 0.0 && simulated->nominal > 0.0) {
            chart_data_add(&d, (double[]){add_name(&names, run), run->nominal, simulated->nominal});
        }
    }
    chart drawn = over_runs(&names, "one-cycle error, %");
    drawn.series[0] =
        (chart_series){"recorded drive", &d, 1, CHART_FAINT, CHART_BARS, CHART_ALWAYS, 0.0, false};
    drawn.series[1] =
        (chart_series){"simulated drive", &d, 2, CHART_PURPLE, CHART_BARS, CHART_ALWAYS, 0.0, false};
    const bool ok = page_chart(p, &drawn, "plant-runs",
                               "One-cycle error of the nominal model on the recorded drive and on the "
                               "simulated drive with these causes.",
                               e);
    chart_data_free(&d);
    return ok;
}

/* ---- Method by method ---- */

bool figure_methods(page *p, const report_context *c, error *e)
{
    static const char *const names[] = {"Euler", "quasi-discrete", "exact"};
    const diagnosis_method *nominal = &c->d->method_nominal;
    const diagnosis_method *extended = &c->d->method_extended;
    chart_data d = chart_data_of(3);
    chart_data_add(&d, (double[]){0.0, nominal->euler, extended->euler});
    chart_data_add(&d, (double[]){1.0, nominal->quasi_discrete, extended->quasi_discrete});
    chart_data_add(&d, (double[]){2.0, nominal->exact, extended->exact});
    chart drawn = {.x_label = "method",
                   .y_label = "one-cycle error, %",
                   .y = {.logarithmic = true},
                   .name = names,
                   .names = 3};
    drawn.series[0] = figure_nominal(c, &d, 1, CHART_POINTS);
    drawn.series[1] = figure_extended(c, &d, 2, CHART_POINTS);
    const bool ok = page_chart(
        p, &drawn, "methods",
        "The same parameters in three discretisations: forward Euler, the quasi-discrete form of the "
        "2019 paper (both with the mean of L_d and L_q) and the exact step, which the diagnosis uses. "
        "Logarithmic scale.",
        e);
    chart_data_free(&d);
    return ok;
}

/* ---- Order by order ---- */

/* Returns the largest amplitude. */
static double add_orders(chart_data *d, const residual *r, int parts)
{
    double most = 0.0;
    double amplitude[ORDERS];
    residual_orders(r, parts, amplitude);
    for (int n = 0; n < order_count(parts); n++) {
        if (isfinite(amplitude[n])) {
            chart_data_add(d, (double[]){order_of(parts, n), amplitude[n]});
            most = fmax(most, amplitude[n]);
        }
    }
    return most;
}

bool figure_orders(page *p, const report_context *c, error *e)
{
    const int parts = order_parts(c->nominal->pole_pairs);
    chart_data before = chart_data_of(2);
    chart_data after = chart_data_of(2);
    chart_data plant = chart_data_of(2);
    const double most = add_orders(&before, &c->before, parts);
    add_orders(&after, &c->after, parts);
    chart drawn = {.x_label = "order of the electrical frequency (negative: against the rotor)",
                   .y_label = "residual voltage, V",
                   .x = {.fixed = true, .low = -ORDER_MAX - 0.5, .high = ORDER_MAX + 0.5},
                   .y = {.logarithmic = true,
                         .fixed = true,
                         .low = fmax(2e-3 * most, 1e-9),
                         .high = fmax(1.4 * most, 1e-8)},
                   .height = 300};
    size_t n = 0;
    drawn.series[n++] = figure_nominal(c, &before, 1, CHART_LINE);
    if (c->plant.error != NULL) {
        add_orders(&plant, &c->plant, parts);
        drawn.series[n++] =
            (chart_series){"simulated drive", &plant, 1, CHART_PURPLE, CHART_LINE, CHART_ALWAYS, 1.2, true};
    }
    drawn.series[n] = figure_extended(c, &after, 1, CHART_LINE);
    char caption[500];
    snprintf(caption, sizeof caption,
             "Spectrum of the residual voltage vector over the rotor angle, in steps of 1/%d electrical "
             "order; one "
             "mechanical order is 1/%d. A dead time shows at -5, 1 and 7, unequal phases or sensors at -1, "
             "an offset "
             "at 0.",
             parts, c->nominal->pole_pairs);
    const bool ok = page_chart(p, &drawn, "orders", caption, e);
    chart_data_free(&before);
    chart_data_free(&after);
    chart_data_free(&plant);
    return ok;
}

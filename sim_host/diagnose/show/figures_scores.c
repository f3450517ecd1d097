/* Charts of errors and spectra: per run, per method, per order (figures.h). */
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

bool figure_runs(page *p, const evidence *v, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(4);
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        chart_data_add(&d, (double[]){add_name(&names, run), positive(run->nominal), positive(run->extended),
                                      positive(run->noise_floor)});
    }
    const chart_series noise = {"noise alone", &d, 3, CHART_GREEN, CHART_POINTS, CHART_ALWAYS, 0.0, false};
    chart drawn = over_runs(&names, "one-cycle error, %");
    drawn.series[0] = figure_nominal(v, &d, 1, CHART_BARS);
    drawn.series[1] = v->extended ? figure_extended(v, &d, 2, CHART_BARS) : noise;
    drawn.series[2] = v->extended ? noise : (chart_series){.label = NULL};
    const bool ok =
        page_chart(p, &drawn, "runs",
                   "One-cycle prediction, rms of the error over rms of the current, on rows that were not "
                   "used for fitting.",
                   e);
    chart_data_free(&d);
    return ok;
}

bool figure_free_runs(page *p, const evidence *v, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(3);
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        chart_data_add(&d, (double[]){add_name(&names, run), fmax(run->free_nominal, 1e-3),
                                      fmax(run->free_extended, 1e-3)});
    }
    chart drawn = over_runs(&names, "free-run error, %");
    drawn.y.logarithmic = true;
    drawn.series[0] = figure_nominal(v, &d, 1, CHART_POINTS);
    drawn.series[1] = figure_extended(v, &d, 2, CHART_POINTS);
    const bool ok = page_chart(
        p, &drawn, "free-runs",
        "Free run over whole stretches: errors add up, so that this is the harder test. Logarithmic.", e);
    chart_data_free(&d);
    return ok;
}

bool figure_plant_runs(page *p, const evidence *v, error *e)
{
    run_names names = {.count = 0};
    chart_data d = chart_data_of(3);
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        const diagnosis_run *simulated = plant_witness_run(v->witness, v->d, k);
        if (simulated != NULL && run->nominal > 0.0 && simulated->nominal > 0.0) {
            chart_data_add(&d, (double[]){add_name(&names, run), run->nominal, simulated->nominal});
        }
    }
    chart drawn = over_runs(&names, "one-cycle error, %");
    drawn.series[0] = (chart_series){"machine", &d, 1, CHART_FAINT, CHART_BARS, CHART_ALWAYS, 0.0, false};
    drawn.series[1] = (chart_series){"plant", &d, 2, CHART_PURPLE, CHART_BARS, CHART_ALWAYS, 0.0, false};
    const bool ok = page_chart(
        p, &drawn, "plant-runs",
        "The model as it was: its one-cycle error on the machine and on the plant with the named effect.", e);
    chart_data_free(&d);
    return ok;
}

/* ---- Method by method ---- */

bool figure_methods(page *p, const evidence *v, error *e)
{
    static const char *const names[] = {"Euler", "quasi-discrete", "exact"};
    const diagnosis_method *was = &v->d->method_nominal;
    const diagnosis_method *is = &v->d->method_extended;
    chart_data d = chart_data_of(3);
    chart_data_add(&d, (double[]){0.0, was->euler, is->euler});
    chart_data_add(&d, (double[]){1.0, was->quasi_discrete, is->quasi_discrete});
    chart_data_add(&d, (double[]){2.0, was->exact, is->exact});
    chart drawn = {.x_label = "method",
                   .y_label = "one-cycle error, %",
                   .y = {.logarithmic = true},
                   .name = names,
                   .names = 3};
    drawn.series[0] = figure_nominal(v, &d, 1, CHART_POINTS);
    drawn.series[1] = figure_extended(v, &d, 2, CHART_POINTS);
    const bool ok =
        page_chart(p, &drawn, "methods",
                   "How much is the method's: the same parameters in forward Euler, in the 2019 paper's "
                   "quasi-discrete form (both for "
                   "one inductance, the mean) and in the exact step that this diagnosis uses. Logarithmic.",
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

bool figure_orders(page *p, const evidence *v, error *e)
{
    const int parts = order_parts(v->nominal->pole_pairs);
    chart_data before = chart_data_of(2);
    chart_data after = chart_data_of(2);
    chart_data plant = chart_data_of(2);
    const double most = add_orders(&before, &v->before, parts);
    add_orders(&after, &v->after, parts);
    chart drawn = {.x_label = "order of the electrical frequency (negative: against the rotor)",
                   .y_label = "missing voltage, V",
                   .x = {.fixed = true, .low = -ORDER_MAX - 0.5, .high = ORDER_MAX + 0.5},
                   .y = {.logarithmic = true,
                         .fixed = true,
                         .low = fmax(2e-3 * most, 1e-9),
                         .high = fmax(1.4 * most, 1e-8)},
                   .height = 300};
    size_t n = 0;
    drawn.series[n++] = figure_nominal(v, &before, 1, CHART_LINE);
    if (v->plant.error != NULL) {
        add_orders(&plant, &v->plant, parts);
        drawn.series[n++] =
            (chart_series){"on the plant", &plant, 1, CHART_PURPLE, CHART_LINE, CHART_ALWAYS, 1.2, true};
    }
    drawn.series[n] = figure_extended(v, &after, 1, CHART_LINE);
    char caption[500];
    snprintf(caption, sizeof caption,
             "Spectrum of the missing voltage vector over the rotor's angle, in steps of 1/%d of an "
             "electrical order; one "
             "mechanical order is 1/%d. Dead time shows at -5, 1 and 7, unequal phases and sensors at -1, an "
             "offset at 0.",
             parts, v->nominal->pole_pairs);
    const bool ok = page_chart(p, &drawn, "orders", caption, e);
    chart_data_free(&before);
    chart_data_free(&after);
    chart_data_free(&plant);
    return ok;
}

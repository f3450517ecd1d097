/* Figures of errors and spectra: per run, per method, per order. */
#include "figures.h"

#include <math.h>

static bool begin_bars(plot *drawing, int height, const char *ylabel, error *e)
{
    if (!plot_begin(drawing, 560, height, e)) {
        return false;
    }
    plot_say(
        drawing,
        "set style data histograms\nset style histogram clustered gap 1\nset style fill solid 0.85 noborder\n"
        "set boxwidth 0.9\nset yrange [0:*]\nset ylabel '%s'\nset key at graph 1,1.11 right horizontal "
        "maxrows 1 samplen 1\n"
        "set tmargin 2.5\nset grid noxtics\n",
        ylabel);
    return true;
}

static void say_run(plot *drawing, const diagnosis_run *run, double x, double y, double z)
{
    plot_say(drawing, "\"%ld\\n%.0f\" %.5g %.5g %.5g\n", run->run, nearbyint(run->omega_rad_s) + 0.0, x, y,
             z);
}

bool figure_runs(page *p, const evidence *v, error *e)
{
    plot drawing;
    if (!begin_bars(&drawing, 360, "one-cycle error, %", e)) {
        return false;
    }
    plot_data(&drawing, "runs");
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        say_run(&drawing, run, run->nominal, run->extended, run->noise_floor);
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set xlabel 'run, and its electrical speed in rad/s' offset 0,-0.4\nset bmargin 4.6\n%s",
             v->d->runs > 14 ? "set xtics rotate by 90 font ',9'\n" : "");
    plot_say(&drawing, "plot $runs using 2:xtic(1) linestyle 2 title '%s'", v->was);
    if (v->extended) {
        plot_say(&drawing, ", $runs using 3 linestyle 1 title 'extended'");
    }
    plot_say(&drawing, ", $runs using 4 linestyle 9 title 'noise alone'\n");
    return page_figure(p, &drawing, "runs",
                       "One-cycle prediction, rms of the error over rms of the current, on rows that were "
                       "not used for fitting.",
                       e);
}

bool figure_free_runs(page *p, const evidence *v, error *e)
{
    plot drawing;
    if (!begin_bars(&drawing, 360, "free-run error, %", e)) {
        return false;
    }
    plot_data(&drawing, "runs");
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        say_run(&drawing, run, fmax(run->free_nominal, 1e-3), fmax(run->free_extended, 1e-3), 0.0);
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set logscale y\nset yrange [*:*]\nset offsets 0,0,graph 0.05,graph 0.1\nset xlabel 'run, and "
             "its electrical speed in "
             "rad/s' offset 0,-0.4\nset bmargin 4.6\n%splot $runs using 2:xtic(1) with points linestyle 2 "
             "pointsize 1.1 "
             "title '%s'",
             v->d->runs > 14 ? "set xtics rotate by 90 font ',9'\n" : "", v->was);
    if (v->extended) {
        plot_say(&drawing, ", $runs using 3 with points linestyle 1 pointsize 1.1 title 'extended'");
    }
    plot_say(&drawing, "\n");
    return page_figure(
        p, &drawing, "free-runs",
        "Free run over whole stretches: errors add up, so that this is the harder test. Logarithmic.", e);
}

bool figure_methods(page *p, const evidence *v, error *e)
{
    plot drawing;
    const diagnosis_method *was = &v->d->method_nominal;
    const diagnosis_method *is = &v->d->method_extended;
    if (!begin_bars(&drawing, 320, "one-cycle error, %", e)) {
        return false;
    }
    plot_data(&drawing, "methods");
    plot_say(&drawing, "Euler %.5g %.5g\n\"quasi-discrete\" %.5g %.5g\nexact %.5g %.5g\n", was->euler,
             is->euler, was->quasi_discrete, is->quasi_discrete, was->exact, is->exact);
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set logscale y\nset yrange [*:*]\nset offsets 0,0,0,graph 0.1\nplot $methods using "
             "2:xtic(1) linestyle 2 "
             "title '%s'",
             v->was);
    if (v->extended) {
        plot_say(&drawing, ", $methods using 3 linestyle 1 title 'extended'");
    }
    plot_say(&drawing, "\n");
    return page_figure(
        p, &drawing, "methods",
        "How much is the method's: the same parameters in forward Euler, in the 2019 paper's quasi-discrete "
        "form (both for "
        "one inductance, the mean) and in the exact step that this diagnosis uses. Logarithmic.",
        e);
}

/* Returns the largest amplitude. */
static double say_orders(plot *drawing, const char *name, const residual *r, int parts)
{
    double most = 0.0;
    double amplitude[ORDERS];
    residual_orders(r, parts, amplitude);
    plot_data(drawing, name);
    for (int n = 0; n < order_count(parts); n++) {
        if (isfinite(amplitude[n])) {
            plot_say(drawing, "%.5g %.5g\n", order_of(parts, n), amplitude[n]);
            most = fmax(most, amplitude[n]);
        }
    }
    plot_data_end(drawing);
    return most;
}

bool figure_orders(page *p, const evidence *v, error *e)
{
    plot drawing;
    const int parts = order_parts(v->nominal->pole_pairs);
    char caption[500];
    if (!plot_begin(&drawing, 560, 430, e)) {
        return false;
    }
    const double most = say_orders(&drawing, "before", &v->before, parts);
    say_orders(&drawing, "after", &v->after, parts);
    if (v->plant.error != NULL) {
        say_orders(&drawing, "plant", &v->plant, parts);
    }
    plot_say(&drawing,
             "set xlabel 'order of the electrical frequency (negative: against the rotor)'\nset "
             "ylabel 'missing voltage, V'\n"
             "set xrange [-13.5:13.5]\nset xtics -12,2,12\nset mxtics 2\nset logscale y\nset format y "
             "'%%g'\nset yrange [%g:*]\n"
             "set key at graph 1,1.09 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset "
             "tmargin 2.5\n"
             "plot $before using 1:2 with lines linestyle 2 title '%s'",
             fmax(2e-3 * most, 1e-9), v->was);
    if (v->plant.error != NULL) {
        plot_say(&drawing,
                 ", $plant using 1:2 with lines linestyle 4 linewidth 1.2 dashtype 2 title 'on the plant'");
    }
    if (v->extended) {
        plot_say(&drawing, ", $after using 1:2 with lines linestyle 1 title 'extended'");
    }
    plot_say(&drawing, "\n");
    snprintf(caption, sizeof caption,
             "Spectrum of the missing voltage vector over the rotor's angle, in steps of 1/%d of an "
             "electrical order; one mechanical order is "
             "1/%d. Dead time shows at -5, 1 and 7, unequal phases and sensors at -1, an offset at 0.",
             parts, v->nominal->pole_pairs);
    return page_figure(p, &drawing, "orders", caption, e);
}

bool figure_plant_runs(page *p, const evidence *v, error *e)
{
    plot drawing;
    if (!begin_bars(&drawing, 380, "one-cycle error, %", e)) {
        return false;
    }
    plot_data(&drawing, "runs");
    for (size_t k = 0; k < v->d->runs; k++) {
        const diagnosis_run *run = &v->d->run[k];
        const diagnosis_run *simulated = plant_witness_run(v->witness, v->d, k);
        if (simulated != NULL && run->nominal > 0.0 && simulated->nominal > 0.0) {
            say_run(&drawing, run, run->nominal, simulated->nominal, 0.0);
        }
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set xlabel 'run, and its electrical speed in rad/s' offset 0,-0.4\nset bmargin 4.6\n%splot "
             "$runs using 2:xtic(1) linestyle "
             "9 title 'machine', $runs using 3 linestyle 4 title 'plant'\n",
             v->d->runs > 14 ? "set xtics rotate by 90 font ',9'\n" : "");
    return page_figure(
        p, &drawing, "plant-runs",
        "The model as it was: its one-cycle error on the machine and on the plant with the named effect.", e);
}

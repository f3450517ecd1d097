/* The errors over speed (sweep.h) as a page and a picture. */
#include "sweep.h"

#include "../report/page.h"

#include <math.h>

/* What falls below is rounding and the plant's own; the axis ends there. */
static const double least_percent = 1e-4;

static void say_points(plot *p, const sweep_point *points, size_t count)
{
    plot_data(p, "errors");
    for (size_t n = 0; n < count; n++) {
        const method_error *errors = points[n].errors.of;
        if (isfinite(points[n].sffr)) {
            plot_say(p, "%.5g %.4g %.4g %.4g %.4g %.4g %.4g\n", points[n].sffr,
                     errors[METHOD_MEAN_STANDARD].rms_percent, errors[METHOD_MEAN_QUASI_DISCRETE].rms_percent,
                     fmax(points[n].exact.mean.rms_percent, least_percent),
                     errors[METHOD_PREDICTION_STANDARD].rms_percent,
                     errors[METHOD_PREDICTION_QUASI_DISCRETE].rms_percent,
                     fmax(points[n].exact.prediction.rms_percent, least_percent));
        }
    }
    plot_data_end(p);
}

static void say_panel(plot *p, int column, const char *title, bool with_key)
{
    plot_say(p,
             "set title '%s'\n%s\nplot $errors using 1:%d with linespoints linestyle 1 title 'standard', "
             "$errors using 1:%d with linespoints linestyle 2 title 'quasi-discrete', "
             "$errors using 1:%d with linespoints linestyle 3 title 'exact'\n",
             title, with_key ? "set key bottom left font ',11'" : "unset key", column, column + 1,
             column + 2);
}

static bool draw(page *to, const motor *m, const sweep_point *points, size_t count, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 760, 380, e)) {
        return false;
    }
    say_points(&drawing, points, count);
    plot_say(&drawing,
             "set logscale xy\nset autoscale xfix\nset offsets graph 0.05, graph 0.05, 0, 0\nset format y "
             "'%%g'\nset yrange [%g:200]\nset xtics (3,6,12,25,50,100,200)\n"
             "set xlabel 'SFFR'\nset ylabel 'error, %% of the rms current'\n"
             "set multiplot layout 1,2 margins 0.1,0.985,0.13,0.92 spacing 0.12,0\n",
             least_percent);
    say_panel(&drawing, 2, "mean current", true);
    say_panel(&drawing, 5, "prediction", false);
    plot_say(&drawing, "unset multiplot\n");
    char caption[512];
    snprintf(caption, sizeof caption,
             "%s: errors over the switching-to-fundamental frequency ratio (SFFR), switching-level drive in "
             "steady state.",
             m->name);
    return page_figure(to, &drawing, "sweep", caption, e);
}

bool sweep_page(const char *directory, const motor *m, const sweep_point *points, size_t count, error *e)
{
    page p;
    return page_begin(&p, directory, "Errors over speed",
                      "Mean current over a cycle and predicted current: standard, quasi-discrete, exact.",
                      e) &&
           page_finish(&p, draw(&p, m, points, count, e), e);
}

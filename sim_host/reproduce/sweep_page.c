/* The errors over speed (sweep.h) as a page. */
#include "sweep.h"

#include "../report/page.h"

#include <math.h>

/* What falls below is rounding and the plant's own; the axis ends there. */
static const double least_percent = 1e-4;

static chart_data points_of(const sweep_point *points, size_t count)
{
    chart_data d = chart_data_of(7);
    /* A chart's x rises, the speeds may come in any order. */
    for (double last = -INFINITY;;) {
        const sweep_point *next = NULL;
        for (size_t n = 0; n < count; n++) {
            const double at = points[n].sffr;
            if (isfinite(at) && at > last && (next == NULL || at < next->sffr)) {
                next = &points[n];
            }
        }
        if (next == NULL) {
            return d;
        }
        const method_error *errors = next->errors.of;
        last = next->sffr;
        chart_data_add(&d, (double[]){last, errors[METHOD_MEAN_STANDARD].rms_percent,
                                      errors[METHOD_MEAN_QUASI_DISCRETE].rms_percent,
                                      fmax(next->exact.mean.rms_percent, least_percent),
                                      errors[METHOD_PREDICTION_STANDARD].rms_percent,
                                      errors[METHOD_PREDICTION_QUASI_DISCRETE].rms_percent,
                                      fmax(next->exact.prediction.rms_percent, least_percent)});
    }
}

static chart errors_chart(const chart_data *d, size_t column, const char *title)
{
    return (chart){
        .title = title,
        .x_label = "SFFR",
        .y_label = "error, % of the rms current",
        .x = {.logarithmic = true},
        .y = {.logarithmic = true, .fixed = true, .low = least_percent, .high = 200.0},
        .series = {
            {"standard", d, column, CHART_BLUE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false},
            {"quasi-discrete", d, column + 1, CHART_ORANGE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false},
            {"exact", d, column + 2, CHART_GREEN, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false}}};
}

static bool draw(page *to, const motor *m, const sweep_point *points, size_t count, error *e)
{
    chart_data d = points_of(points, count);
    const chart drawn[] = {errors_chart(&d, 1, "mean current"), errors_chart(&d, 4, "prediction")};
    char caption[512];
    snprintf(caption, sizeof caption,
             "%s: errors over the switching-to-fundamental frequency ratio (SFFR), switching-level drive in "
             "steady state.",
             m->name);
    const bool ok = page_charts(to, drawn, 2, "sweep", caption, e);
    chart_data_free(&d);
    return ok;
}

bool sweep_page(const char *directory, const motor *m, const sweep_point *points, size_t count, error *e)
{
    page p;
    return page_begin(&p, directory, "Errors over speed",
                      "Mean current over a cycle and predicted current: standard, quasi-discrete, exact.",
                      e) &&
           page_finish(&p, draw(&p, m, points, count, e), e);
}

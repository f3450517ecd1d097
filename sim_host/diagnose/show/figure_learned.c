/* Fitted terms of an effect without a named cause, over the variable of the strongest term (figures.h). */
#include "figures.h"

bool figure_learned(page *p, const report_context *c, error *e)
{
    const diagnosis_learned *l = &c->d->learned;
    chart_data d = chart_data_of(3);
    for (size_t n = 0; n < l->points; n++) {
        chart_data_add(&d, (double[]){l->point[n].x, l->point[n].left, l->point[n].learned});
    }
    char y_label[64];
    snprintf(y_label, sizeof y_label, "residual %s (mean)", l->voltage);
    const chart drawn = {
        .x_label = l->axis,
        .y_label = y_label,
        .x = {.fixed = l->turns, .low = 0.0, .high = 360.0},
        .series = {{"extended model", &d, 1, CHART_ORANGE, CHART_POINTS, CHART_ALWAYS, 0.0, false},
                   {"fitted terms", &d, 2, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false}}};
    const bool ok =
        page_chart(p, &drawn, "learned",
                   "Residual of the extended model and the fitted terms, over the variable of the "
                   "strongest term. Means over held-out rows.",
                   e);
    chart_data_free(&d);
    return ok;
}

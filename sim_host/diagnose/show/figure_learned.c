/* What was learned of an effect without a name, over what its strongest term depends on (figures.h). */
#include "figures.h"

bool figure_learned(page *p, const evidence *v, error *e)
{
    const diagnosis_learned *l = &v->d->learned;
    chart_data d = chart_data_of(3);
    for (size_t n = 0; n < l->points; n++) {
        chart_data_add(&d, (double[]){l->point[n].x, l->point[n].left, l->point[n].learned});
    }
    char y_label[64];
    snprintf(y_label, sizeof y_label, "missing %s (mean)", l->voltage);
    const chart drawn = {
        .x_label = l->axis,
        .y_label = y_label,
        .x = {.fixed = l->turns, .low = 0.0, .high = 360.0},
        .series = {{"left over", &d, 1, CHART_ORANGE, CHART_POINTS, CHART_ALWAYS, 0.0, false},
                   {"learned", &d, 2, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false}}};
    const bool ok = page_chart(p, &drawn, "learned",
                               "What the extended model leaves and what was learned of it, over what the "
                               "strongest term depends on: means over "
                               "rows that were not fitted.",
                               e);
    chart_data_free(&d);
    return ok;
}

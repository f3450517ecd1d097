/* The page of a replay: its errors in tables, and over time (observe.h). */
#include "observe.h"

#include "report/page.h"

#include <math.h>

static void error_row(page *p, double low, const spread *x)
{
    if (x->count > 0) {
        page_row_begin(p);
        page_cell(p, true, "%.4g", low);
        page_cell(p, true, "%ld", x->count);
        page_cell(p, true, "%.2f", spread_mean(x));
        page_cell(p, true, "%.2f", spread_deviation(x));
        page_cell(p, true, "%.2f", spread_most(x));
        page_row_end(p);
    }
}

static void error_table(page *p, const char *name, const spread *part, const double *share, int parts,
                        double unit)
{
    const char *const heads[] = {name, "\trows", "\tbias, degrees", "\trms, degrees", "\tat most, degrees"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int n = 0; n < parts; n++) {
        error_row(p, share[n] * unit, &part[n]);
    }
    page_table_end(p);
}

static bool draw(page *p, const chart_data *series, error *e)
{
    const chart usual = {.x_label = "rows as time, s", .group = "observe", .height = 230};
    chart drawn[2] = {usual, usual};
    drawn[0].y_label = "speed, rpm";
    drawn[0].series[0] =
        (chart_series){.label = "recorded", .data = series, .column = 1, .colour = CHART_ORANGE};
    drawn[0].series[1] =
        (chart_series){.label = "observed", .data = series, .column = 2, .colour = CHART_BLUE};
    drawn[1].y_label = "angle error, degrees";
    drawn[1].series[0] =
        (chart_series){.label = "observed minus recorded", .data = series, .column = 3, .colour = CHART_BLUE};
    return page_charts(p, drawn, 2, "observe",
                       "Speed, and the error of the angle in settled rows. The runs follow one another.", e);
}

static bool parts(page *p, const motor *m, const observe_result *r, const chart_data *series, error *e)
{
    page_lead(p, "Locked in %ld of %ld rows. Lost %ld times by the angle, %ld by the flux, %ld by low speed.",
              r->locked, r->rows, r->lost[0], r->lost[1], r->lost[2]);
    if (r->all.count == 0) {
        page_text(p, "No settled row above %.4g rpm: no error to show.", r->least_rpm);
    } else {
        page_text(p,
                  "Above %.4g rpm the observed angle minus the recorded one has a bias of %.2f, an rms of "
                  "%.2f and at most "
                  "%.2f degrees.",
                  r->least_rpm, spread_mean(&r->all), spread_deviation(&r->all), spread_most(&r->all));
    }
    if (!draw(p, series, e)) {
        return false;
    }
    page_heading(p, 2, "Over speed and current");
    error_table(p, "\tfrom, rpm", r->by_speed, observe_speed_share, OBSERVE_SPEEDS, m->n_max_rpm);
    error_table(p, "\tfrom, A", r->by_current, observe_current_share, OBSERVE_CURRENTS,
                motor_rated_peak_A(m));
    page_note(p, "Settled rows: locked for %d rows. A constant bias may be the offset of the recorded angle.",
              (int)OBSERVE_SETTLED_ROWS);
    return true;
}

bool observe_page(const char *directory, const motor *m, const observe_result *result,
                  const chart_data *series, error *e)
{
    page p;
    char title[200];
    (void)snprintf(title, sizeof title, "%s: observer without a sensor", m->name);
    return page_begin(&p, directory, title, "The firmware's observer over a recording, against its angle.",
                      e) &&
           page_finish(&p, parts(&p, m, result, series, e), e);
}

/* The observer's part of a design's page (tune_observer_page.h). */
#include "tune_observer_page.h"

#include "base/number.h"

#include <math.h>

static chart_series line(const char *label, const chart_data *d, size_t column, chart_colour colour)
{
    return (chart_series){label, d, column, colour, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false};
}

/* From 0 to a little above the largest value of some columns. */
static chart_axis from_zero(const chart_data *d, size_t first, size_t last)
{
    chart_axis axis = {.fixed = true, .low = 0.0, .high = 0.0};
    for (size_t row = 0; row < d->rows; row++) {
        for (size_t n = first; n <= last; n++) {
            const double value = d->value[row * d->columns + n];
            axis.high = isfinite(value) ? fmax(axis.high, 1.1 * value) : axis.high;
        }
    }
    return axis;
}

static bool figure(page *p, const tune_report *t, error *e)
{
    enum { PANELS = 3 };
    const tune_observer *o = &t->observer;
    chart_data d = chart_data_of(6);
    for (int s = 0; s < TUNE_OBSERVER_SPEEDS; s++) {
        const tune_observer_speed *at = &o->at[s];
        const double angle_deg = isfinite(at->angle_deg) ? at->angle_deg : NAN;
        chart_data_add(&d, (double[]){at->rpm, at->disk_nominal, at->disk, t->result.at[s + 1].worst.disk,
                                      angle_deg, at->noise_deg});
    }
    const chart_axis x = {.fixed = true, .low = 0.0, .high = t->result.motor.n_max_rpm};
    const chart drawn[PANELS] = {{.title = "disk margin",
                                  .x_label = "speed, rpm",
                                  .x = x,
                                  .y = from_zero(&d, 1, 3),
                                  .series = {line("nominal machine", &d, 1, CHART_BLUE),
                                             line("worst of the uncertainty set", &d, 2, CHART_ORANGE),
                                             line("worst with an angle sensor", &d, 3, CHART_FAINT)}},
                                 {.title = "steady angle error, degrees",
                                  .x_label = "speed, rpm",
                                  .x = x,
                                  .y = from_zero(&d, 4, 4),
                                  .series = {line("worst of the uncertainty set", &d, 4, CHART_ORANGE)}},
                                 {.title = "noise of the angle, degrees rms",
                                  .x_label = "speed, rpm",
                                  .x = x,
                                  .y = from_zero(&d, 5, 5),
                                  .series = {line("nominal machine", &d, 5, CHART_BLUE)}}};
    const bool ok = page_charts(
        p, drawn, PANELS, "tune-observer",
        "Without an angle sensor, over the speed. The uncertainty set has both ends of psi_f and an "
        "error of the voltage of 2 % in addition, at the rated current of both signs.",
        e);
    chart_data_free(&d);
    return ok;
}

static void choices(page *p, const tune_observer *o)
{
    static const char *const heads[] = {"\tbandwidth, rad/s", "\trun-up, s", "\tnoise, degrees rms",
                                        "\tworst disk margin"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int n = 0; n < TUNE_OBSERVER_CHOICES; n++) {
        const tune_observer_choice *c = &o->choice[n];
        page_row_begin(p);
        page_cell(p, true, "%.0f", c->bandwidth_rad_s);
        page_cell(p, true, "%.3g", c->run_up_s);
        page_cell(p, true, "%.3f", c->noise_deg);
        page_cell(p, true, "%.3f", c->disk);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p,
              "Other bandwidths. run-up: from standstill to n_max, with a lag of %g degrees. Choose it by "
              "--run-up. "
              "The margin is the worst of every other speed, motoring.",
              TUNE_LAG_DEG);
}

bool tune_observer_part(page *p, const tune_report *t, error *e)
{
    const tune_observer *o = &t->observer;
    const tune_observer_trial *trial = &t->observer_trial;
    page_heading(p, 2, "Without an angle sensor");
    if (o->none != NULL) {
        page_text(p, "No observer: %s.", o->none);
        return true;
    }
    const tune_observer_speed *disk = &o->at[o->disk_worst];
    const tune_observer_speed *angle = &o->at[o->angle_worst];
    page_lead(p,
              "Bandwidth of the observer's loop: %.0f rad/s%s. Worst disk margin %.2f at %.0f rpm with %s.",
              o->bandwidth_rad_s, o->fastest ? ", the highest" : "", disk->disk, disk->rpm, disk->disk_worst);
    page_text(
        p,
        "It lags %g degrees in a run-up of %g s. Largest steady angle error: %.1f degrees at %.0f rpm with "
        "%s. "
        "Noise of a current sensor: %.3g A, %s. Put IQFOC_TUNED_OBSERVER of iqfoc_tuned.h into the firmware.",
        TUNE_LAG_DEG, o->run_up_s, angle->angle_deg, angle->rpm, angle->angle_worst, o->noise_A,
        o->noise_measured ? "by the diagnosis" : "assumed");
    if (!figure(p, t, e)) {
        return false;
    }
    choices(p, o);
    page_text(
        p,
        "Simulated: %d drives of the uncertainty set on the observed angle. Unstable: %d. Lock lost: %d. "
        "Largest "
        "steady angle error: predicted %.1f degrees, simulated %.1f. Largest difference in one drive: %.2f "
        "degrees.",
        trial->drives, trial->unstable, trial->lost, trial->predicted_deg, trial->simulated_deg,
        trial->off_deg);
    return true;
}

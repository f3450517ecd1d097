/* The speed control's part of a design's page (tune_speed_page.h). */
#include "tune_speed_page.h"

#include <math.h>

static chart_series line(const char *label, const chart_data *d, size_t column, chart_colour colour)
{
    return (chart_series){label, d, column, colour, CHART_LINE, CHART_ALWAYS, 0.0, false};
}

/* The set-point behind its ramp, a time after the part's begin. */
static double set_point_rpm(const tune_speed *s, int part, double after_s)
{
    const double ramped = s->ramp_rpm_s * after_s;
    return part == TUNE_RUN_UP   ? fmin(ramped, s->rpm)
           : part == TUNE_LOADED ? s->rpm
                                 : fmin(s->rpm + ramped, (1.0 + TUNE_SPEED_STEP) * s->rpm);
}

/* A panel of speeds and one of currents for each part. */
static bool figure(page *p, const tune_report *t, error *e)
{
    enum { COLUMNS = 2 + 2 * TUNE_SHAFTS, PANELS = 2 * TUNE_PARTS };
    static const char *const titles[TUNE_PARTS] = {"run-up", "load", "step of the set-point"};
    static const char *const shafts[TUNE_SHAFTS] = {"30 % heavier", "inertia as stated", "30 % lighter"};
    static const chart_colour colours[TUNE_SHAFTS] = {CHART_GREEN, CHART_BLUE, CHART_ORANGE};
    const tune_speed *s = &t->speed;
    chart_data d[TUNE_PARTS];
    chart drawn[PANELS];
    for (int part = 0; part < TUNE_PARTS; part++) {
        const tune_trace *trace = &s->trace[part];
        d[part] = chart_data_of(COLUMNS);
        for (int n = 0; n < TUNE_POINTS; n++) {
            const double after_s = n * trace->span_s / TUNE_POINTS;
            double row[COLUMNS] = {1e3 * after_s, set_point_rpm(s, part, after_s)};
            for (int shaft = 0; shaft < TUNE_SHAFTS; shaft++) {
                row[2 + shaft] = trace->rpm[shaft][n];
                row[2 + TUNE_SHAFTS + shaft] = trace->i_q[shaft][n];
            }
            chart_data_add(&d[part], row);
        }
        const chart_axis x = {.fixed = true, .low = 0.0, .high = 1e3 * trace->span_s};
        chart *speeds = &drawn[part];
        chart *currents = &drawn[TUNE_PARTS + part];
        *speeds =
            (chart){.title = titles[part],
                    .x_label = "time, ms",
                    .y_label = "speed, rpm",
                    .x = x,
                    .series = {{"set-point", &d[part], 1, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 1.5, true}}};
        *currents = (chart){
            .title = titles[part], .x_label = "time, ms", .y_label = "i_q over the rated peak", .x = x};
        for (size_t shaft = 0; shaft < TUNE_SHAFTS; shaft++) {
            speeds->series[1 + shaft] = line(shafts[shaft], &d[part], 2 + shaft, colours[shaft]);
            currents->series[shaft] = line(shafts[shaft], &d[part], 2 + TUNE_SHAFTS + shaft, colours[shaft]);
        }
    }
    const bool ok = page_charts(p, drawn, PANELS, "tune-speed",
                                "Firmware in IQ24 with the switching-level plant and its shaft. The time "
                                "counts from the begin of each "
                                "part. The currents are true means of a cycle.",
                                e);
    for (int part = 0; part < TUNE_PARTS; part++) {
        chart_data_free(&d[part]);
    }
    return ok;
}

static void table(page *p, const tune_speed *s)
{
    static const char *const heads[] = {"\tinertia, kg m2", "\tovershoot of the run-up, rpm", "\tdip, rpm",
                                        "\tback within a tenth of the predicted dip, ms",
                                        "\tovershoot of the step, rpm"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int shaft = 0; shaft < TUNE_SHAFTS; shaft++) {
        page_row_begin(p);
        page_cell(p, true, "%.3g", tune_shafts[shaft] * s->J_kgm2);
        page_cell(p, true, "%.1f", s->overshoot_rpm[shaft]);
        page_cell(p, true, "%.1f", s->found_dip_rpm[shaft]);
        page_cell(p, true, "%.1f", 1e3 * s->settled_s[shaft]);
        page_cell(p, true, "%.1f", s->step_overshoot_rpm[shaft]);
        page_row_end(p);
    }
    page_table_end(p);
}

bool tune_speed_part(page *p, const tune_report *t, error *e)
{
    const tune_speed *s = &t->speed;
    if (s->J_kgm2 == 0.0) {
        return true;
    }
    page_heading(p, 2, "Speed control");
    page_lead(p,
              "Bandwidth %.0f rad/s, a step every %d cycles. Disk margin %.2f, with the stated inertia %.2f.",
              s->bandwidth_rad_s, s->cycles, s->disk, s->disk_nominal);
    page_text(p,
              "The margin holds for an inertia %.0f %% lower or higher than %.3g kg m2. The ramp is %.0f "
              "rpm/s%s. A load of %.0f %% of "
              "the rated torque lets the speed dip by %.1f rpm (predicted, stated inertia). Put "
              "IQFOC_TUNED_SPEED and "
              "IQFOC_TUNED_TRACKER of iqfoc_tuned.h into the firmware.",
              100.0 * TUNE_INERTIA_OFF, s->J_kgm2, s->ramp_rpm_s,
              s->ramp_limited ? ", limited by the rated current" : "", 100.0 * s->load, s->dip_rpm);
    if (!figure(p, t, e)) {
        return false;
    }
    table(p, s);
    return true;
}

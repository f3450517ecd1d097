/* The runs through the pulse modes, printed, as JSON and as a page (pulse_run_ups.h). */
#include "pulse_run_ups.h"

#include "base/json_file.h"
#include "report/page.h"

#include <math.h>

const pulse_case pulse_run_ups_case = {0.0, 2.0, 1.0, false, 1.0, 0.0, 0.0};

bool pulse_run_ups_run(pulse_run_ups *all, error *e)
{
    pulse_tables tables;
    bool ok = pulse_tables_find(&tables, e);
    for (int n = 0; n < PULSE_DRIVES && ok; n++) {
        all->drive[n] = pulse_drive_of((pulse_drive_id)n);
        ok = pulse_run_up_run(&all->drive[n], &tables, &pulse_run_ups_case, &all->of[n], e);
    }
    return ok;
}

typedef struct number_text {
    char text[16];
} number_text;

static number_text shown(double x, int decimals)
{
    number_text t = {"-"};
    if (!isnan(x)) {
        (void)snprintf(t.text, sizeof t.text, "%.*f", decimals, x);
    }
    return t;
}

void pulse_run_ups_print(const pulse_run_ups *all, FILE *f)
{
    for (int n = 0; n < PULSE_DRIVES; n++) {
        const pulse_drive *p = &all->drive[n];
        fprintf(f,
                "%sPulse modes: %s, from standstill to %g Hz and back at rated torque; percent of rated\n"
                "  %-20s%9s%9s%10s%10s%12s%12s%10s\n  %-20s%9s%9s%10s%10s%12s%12s%10s\n",
                n > 0 ? "\n" : "", p->text, p->high_Hz, "", "up,", "up,", "down,", "pulses", "distortion",
                "space", "torque", "mode", "from Hz", "to Hz", "to Hz", "a second", "of current", "vectors",
                "error");
        for (int m = 0; m < PULSE_RUN_MODES; m++) {
            const pulse_row *r = &all->of[n].mode[m];
            fprintf(f, "  %-20s%9s%9s%10s%10s%12s%12s%10s\n", pulse_run_mode_text[m],
                    shown(r->from_Hz, 1).text, shown(r->to_Hz, 1).text, shown(r->down_to_Hz, 1).text,
                    shown(r->switching_Hz, 0).text, shown(100.0 * r->distortion, 2).text,
                    shown(100.0 * r->space_vectors, 2).text, shown(r->torque_percent, 2).text);
        }
    }
}

/* ---- JSON ---- */

static json_t *modes_json(const pulse_run_up *r)
{
    json_t *list = json_array();
    for (int m = 0; m < PULSE_RUN_MODES && list != NULL; m++) {
        const pulse_row *row = &r->mode[m];
        list = json_appended(list, json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "mode",
                                             pulse_run_mode_text[m], "up_from_Hz", json_number(row->from_Hz),
                                             "up_to_Hz", json_number(row->to_Hz), "down_to_Hz",
                                             json_number(row->down_to_Hz), "pulses_per_second",
                                             json_number(row->switching_Hz), "distortion_percent",
                                             json_number(100.0 * row->distortion), "space_vectors_percent",
                                             json_number(100.0 * row->space_vectors), "torque_error_percent",
                                             json_number(row->torque_percent)));
    }
    return list;
}

static json_t *points_json(const pulse_run_up *r)
{
    json_t *list = json_array();
    for (int n = 0; n < r->points && list != NULL; n++) {
        const pulse_point *p = &r->point[n];
        list = json_appended(list, json_pack("{s:f, s:s, s:s, s:f, s:f, s:f, s:o}", "Hz", p->hz, "way",
                                             p->up ? "up" : "down", "mode", pulse_run_mode_text[p->mode],
                                             "pulses_per_turn", p->pulses, "pulses_per_second",
                                             p->switching_Hz, "distortion_percent", 100.0 * p->distortion,
                                             "space_vectors_percent", json_number(100.0 * p->space_vectors)));
    }
    return list;
}

json_t *pulse_run_ups_json(const pulse_run_ups *all)
{
    json_t *list = json_array();
    for (int n = 0; n < PULSE_DRIVES && list != NULL; n++) {
        list = json_appended(list, json_pack("{s:s, s:s, s:f, s:o, s:o}", "drive", all->drive[n].key, "text",
                                             all->drive[n].text, "top_Hz", all->drive[n].high_Hz, "modes",
                                             modes_json(&all->of[n]), "points", points_json(&all->of[n])));
    }
    return list == NULL ? NULL : json_pack("{s:o}", "pulse_modes", list);
}

/* ---- The page ---- */

static void mode_table(page *p, const pulse_run_up *r)
{
    static const char *const heads[] = {"mode",
                                        "\tup, from Hz",
                                        "\tup, to Hz",
                                        "\tdown, to Hz",
                                        "\tpulses a second",
                                        "\tdistortion, %",
                                        "\tspace vectors, %",
                                        "\ttorque error, %"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int m = 0; m < PULSE_RUN_MODES; m++) {
        const pulse_row *row = &r->mode[m];
        page_row_begin(p);
        page_cell(p, false, "%s", pulse_run_mode_text[m]);
        page_cell(p, true, "%s", shown(row->from_Hz, 1).text);
        page_cell(p, true, "%s", shown(row->to_Hz, 1).text);
        page_cell(p, true, "%s", shown(row->down_to_Hz, 1).text);
        page_cell(p, true, "%s", shown(row->switching_Hz, 0).text);
        page_cell(p, true, "%s", shown(100.0 * row->distortion, 2).text);
        page_cell(p, true, "%s", shown(100.0 * row->space_vectors, 2).text);
        page_cell(p, true, "%s", shown(row->torque_percent, 2).text);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(p, "Pulses of a leg, the most. Distortion: rms of the current's harmonics over the rated "
                 "current. Space vectors: by "
                 "calculation, with as many pulses a turn at the same voltage; both are means over the "
                 "points that space vectors can "
                 "make. Torque error: the largest, of the mean over 2/3 of a turn, with the changes to the "
                 "mode and from it.");
}

enum { POINT_HZ, POINT_DISTORTION, POINT_SPACE_VECTORS, POINT_SWITCHING, POINT_COLUMNS };

static chart_data points_of(const pulse_run_up *r)
{
    chart_data d = chart_data_of(POINT_COLUMNS);
    double before = 0.0;
    for (int n = 0; n < r->points; n++) {
        const pulse_point *at = &r->point[n];
        if (at->up && at->hz > before) { /* x of a chart rises; the top has one speed */
            chart_data_add(&d, (double[POINT_COLUMNS]){at->hz, 100.0 * at->distortion,
                                                       100.0 * at->space_vectors, at->switching_Hz / 1000.0});
            before = at->hz;
        }
    }
    return d;
}

/* The errors of the way up, or of the way down in turn: by rising speed. */
static chart_data trace_of(const pulse_run_up *r, bool up)
{
    chart_data d = chart_data_of(2);
    double before = -1.0;
    for (int n = 0; n < r->traced; n++) {
        const pulse_error *at = &r->trace[up ? n : r->traced - 1 - n];
        if (at->up == up && at->hz > before) {
            chart_data_add(&d, (double[2]){at->hz, at->percent});
            before = at->hz;
        }
    }
    return d;
}

static bool run_up_figure(page *p, const pulse_drive *drive, const pulse_run_up *r, error *e)
{
    enum { PANELS = 3 };
    char id[64];
    const chart usual = {.x_label = "fundamental frequency, Hz",
                         .x = {.fixed = true, .low = 0.0, .high = drive->high_Hz},
                         .group = drive->key,
                         .height = 220};
    chart drawn[PANELS] = {usual, usual, usual};
    chart_data points = points_of(r);
    chart_data up = trace_of(r, true);
    chart_data down = trace_of(r, false);
    (void)snprintf(id, sizeof id, "loops-pulse-modes-%s", drive->key);
    drawn[0].y_label = "distortion, % of rated";
    drawn[0].series[0] = (chart_series){
        "in the run", &points, POINT_DISTORTION, CHART_BLUE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false};
    drawn[0].series[1] = (chart_series){"space vectors, as many pulses",
                                        &points,
                                        POINT_SPACE_VECTORS,
                                        CHART_ORANGE,
                                        CHART_LINE,
                                        CHART_ALWAYS,
                                        0.0,
                                        true};
    drawn[1].y_label = "1000 pulses a second";
    drawn[1].series[0] = (chart_series){
        "pulses of a leg", &points, POINT_SWITCHING, CHART_BLUE, CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false};
    drawn[2].y_label = "torque error, %";
    drawn[2].series[0] = (chart_series){"way up", &up, 1, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false};
    drawn[2].series[1] =
        (chart_series){"way down", &down, 1, CHART_ORANGE, CHART_LINE, CHART_ALWAYS, 0.0, false};
    const bool ok = page_charts(p, drawn, PANELS, id,
                                "Distortion of the current and pulses on the way up; torque error on both "
                                "ways, the largest within 2 ms.",
                                e);
    chart_data_free(&down);
    chart_data_free(&up);
    chart_data_free(&points);
    return ok;
}

bool pulse_run_ups_page(const pulse_run_ups *all, const char *directory, error *e)
{
    page p;
    if (!page_begin(
            &p, directory, "Run-up through the pulse modes",
            "Fixed carrier, synchronous carrier, pulse patterns and six-step: the library's fixed point on a "
            "switching machine.",
            e)) {
        return false;
    }
    bool ok = true;
    for (int n = 0; n < PULSE_DRIVES && ok; n++) {
        const pulse_drive *drive = &all->drive[n];
        char title[96];
        (void)snprintf(title, sizeof title, "%c%s", drive->text[0] - 'a' + 'A', drive->text + 1);
        page_heading(&p, 2, title);
        page_lead(&p, "From standstill to %g Hz and back at rated torque, %g seconds each way.",
                  drive->high_Hz, pulse_run_ups_case.ramp_s);
        mode_table(&p, &all->of[n]);
        ok = run_up_figure(&p, drive, &all->of[n], e);
    }
    return page_finish(&p, ok, e);
}

/* The page of the patterns: distortion and angles over the index, spectra (patterns.h). */
#include "patterns.h"

#include "base/vector.h"
#include "report/page.h"

#include <math.h>

enum { SPECTRA = 3, COLUMNS = 3 + PATTERN_ANGLES_MOST };

static const int spectrum_row[SPECTRA] = {20, 40, 60}; /* index 0.5, 0.7, 0.9 */
static const chart_colour colours[4] = {CHART_BLUE, CHART_ORANGE, CHART_GREEN, CHART_PURPLE};

/* Index, distortion of both in percent, angles in degrees; with a gap at each jump. */
static chart_data over_index(const patterns_result *r)
{
    chart_data d = chart_data_of(COLUMNS);
    for (int n = 0; n < r->rows; n++) {
        double row[COLUMNS] = {patterns_index(n), 100.0 * r->row[n].distortion,
                               100.0 * r->row[n].space_vectors};
        for (int k = 0; k < PATTERN_ANGLES_MOST; k++) {
            row[3 + k] = k < r->row[n].shape.angles ? r->row[n].shape.angle[k] * 360.0 / VEC_TWO_PI : NAN;
        }
        chart_data_add(&d, row);
        if (n + 1 < r->rows && !r->row[n].joined) {
            double gap[COLUMNS];
            for (int k = 0; k < COLUMNS; k++) {
                gap[k] = NAN;
            }
            gap[0] = patterns_index(n) + 0.005;
            gap[2] = 50.0 * (r->row[n].space_vectors + r->row[n + 1].space_vectors);
            chart_data_add(&d, gap);
        }
    }
    return d;
}

/* The name of a chart: a page has each once. */
static const char *name_of(char name[48], const char *chart_of, const patterns_result *r)
{
    (void)snprintf(name, 48, "patterns-%s-%d", chart_of, r->asked.pulses);
    return name;
}

static bool distortion_chart(page *p, const patterns_result *r, const chart_data *d, error *e)
{
    char name[48];
    const chart drawn = {
        .x_label = "modulation index, share of six-step",
        .y_label = r->asked.m != NULL ? "% of the rated current" : "% of the fundamental flux",
        .series = {{"pattern", d, 1, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false},
                   {"space vectors", d, 2, CHART_ORANGE, CHART_LINE, CHART_ALWAYS, 0.0, false}}};
    return page_chart(
        p, &drawn, name_of(name, "distortion", r),
        "Distortion of the patterns, and of space vectors with as many pulses a turn. A gap is a "
        "jump of the angles.",
        e);
}

static bool angles_chart(page *p, const patterns_result *r, const chart_data *d, error *e)
{
    static const char *const label[PATTERN_ANGLES_MOST] = {"angle 1", "angle 2", "angle 3", "angle 4",
                                                           "angle 5", "angle 6", "angle 7"};
    char name[48];
    chart drawn = {.x_label = "modulation index, share of six-step",
                   .y_label = "switching angle, degrees",
                   .y = {.fixed = true, .low = 0.0, .high = 90.0}};
    for (int k = 0; k < r->row[0].shape.angles; k++) {
        drawn.series[k] = (chart_series){.label = label[k],
                                         .data = d,
                                         .column = (size_t)(3 + k),
                                         .colour = colours[k % 4],
                                         .mark = CHART_LINE,
                                         .dashed = k >= 4};
    }
    return page_chart(
        p, &drawn, name_of(name, "angles", r),
        "Switching angles of leg a in the first quarter of a turn. The pieces differ in the level "
        "after angle 0, or in the place of their pulses.",
        e);
}

static bool spectrum_chart(page *p, const patterns_result *r, error *e)
{
    static const char *const label[SPECTRA] = {"index 0.5", "index 0.7", "index 0.9"};
    char name[48];
    chart_data d = chart_data_of(1 + SPECTRA);
    chart drawn = {.x_label = "order", .y_label = "voltage, % of the fundamental"};
    int shown = 0;
    for (int k = 0; k < SPECTRA; k++) {
        if (spectrum_row[k] < r->rows) {
            drawn.series[shown++] = (chart_series){.label = label[k],
                                                   .data = &d,
                                                   .column = (size_t)(1 + k),
                                                   .colour = colours[k],
                                                   .mark = CHART_LINE_POINTS};
        }
    }
    for (int n = 5; n <= 6 * PATTERN_PAIRS + 1; n += n % 6 == 5 ? 2 : 4) {
        double row[1 + SPECTRA] = {n};
        for (int k = 0; k < SPECTRA; k++) {
            const pattern_shape *s = &r->row[spectrum_row[k]].shape;
            row[1 + k] = spectrum_row[k] < r->rows
                             ? 100.0 * fabs(pattern_harmonic(s, n)) / fabs(pattern_harmonic(s, 1))
                             : NAN;
        }
        chart_data_add(&d, row);
    }
    const bool ok = shown == 0 || page_chart(p, &drawn, name_of(name, "spectra", r),
                                             "Harmonics of the voltage, orders 6 k - 1 and 6 k + 1.", e);
    chart_data_free(&d);
    return ok;
}

static void angle_table(page *p, const patterns_result *r)
{
    static const char *const heads[] = {"\tindex", "\tHz",           "\tpattern, %", "\tspace vectors, %",
                                        "start",   "angles, degrees"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int n = 0; n < r->rows; n++) {
        const patterns_row *row = &r->row[n];
        char angles[12 * PATTERN_ANGLES_MOST] = "";
        size_t at = 0;
        for (int k = 0; k < row->shape.angles; k++) {
            at += (size_t)snprintf(angles + at, sizeof angles - at, "%s%.3f", k > 0 ? ", " : "",
                                   row->shape.angle[k] * 360.0 / VEC_TWO_PI);
        }
        page_row_begin(p);
        page_cell(p, true, "%.2f", patterns_index(n));
        if (r->asked.six_step_Hz > 0.0) {
            page_cell(p, true, "%.4g", r->asked.six_step_Hz * patterns_index(n));
        } else {
            page_cell(p, true, "-");
        }
        page_cell(p, true, "%.2f", 100.0 * row->distortion);
        if (isnan(row->space_vectors)) {
            page_cell(p, true, "-");
        } else {
            page_cell(p, true, "%.2f", 100.0 * row->space_vectors);
        }
        page_cell(p, false, "%s", row->shape.start > 0 ? "high" : "low");
        page_cell(p, false, "%s", angles);
        page_row_end(p);
    }
    page_table_end(p);
}

static bool parts(page *p, const patterns_result *r, error *e)
{
    char heading[40];
    chart_data d = over_index(r);
    (void)snprintf(heading, sizeof heading, "%d pulses a turn", r->asked.pulses);
    page_heading(p, 2, heading);
    page_lead(p, "Index 0.30 to %.2f of six-step; the angles jump %d times.", patterns_index(r->rows - 1),
              r->jumps);
    const bool ok = distortion_chart(p, r, &d, e) && angles_chart(p, r, &d, e) && spectrum_chart(p, r, e);
    chart_data_free(&d);
    page_details_begin(p, "All angles");
    angle_table(p, r);
    page_details_end(p);
    return ok;
}

bool patterns_page(const patterns_result *r, size_t count, const char *directory, error *e)
{
    page p;
    char title[200];
    (void)snprintf(title, sizeof title, "%.150s%soptimal pulse patterns",
                   r->asked.m != NULL ? r->asked.m->name : "", r->asked.m != NULL ? ": " : "");
    if (!page_begin(&p, directory, title, "Switching angles over the modulation index.", e)) {
        return false;
    }
    bool ok = true;
    for (size_t n = 0; n < count && ok; n++) {
        ok = parts(&p, &r[n], e);
    }
    return page_finish(&p, ok, e);
}

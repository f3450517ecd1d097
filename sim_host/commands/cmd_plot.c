/* iqfoc plot: a recording as a page of charts. */
#include "base/vector.h"
#include "command.h"
#include "data/motor.h"
#include "data/recording.h"
#include "report/page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *motor_path, *output;

static const option_spec specs[] = {
    {"output", 'o', "F.html", "the page to write", .text = &output, .written = true},
    {"motor", 'm', "M.toml", "the motor file: speed in rpm, and its currents i_d and i_q",
     .text = &motor_path},
    {.name = NULL}};

const command_about about_plot = {
    "plot", "REC.csv -o F.html [--motor M.toml]",
    "Draws a recording: phase currents, currents i_d and i_q at the recorded angle, voltages and speed over\n"
    "time. The page opens from disk, without a network; drag to zoom.",
    specs};

enum { C_T, C_PHASE, C_DQ = C_PHASE + 3, C_U = C_DQ + 2, C_SPEED = C_U + 3, COLUMNS };

static void fill_row(const recording *r, size_t k, double per_speed, double *row)
{
    const vec_dq i = vec_to_dq(recording_current(r, k), rotor_at(r->theta_e_rad[k]));
    for (int x = 0; x < 3; x++) {
        row[C_PHASE + x] = r->i_A[x][k];
    }
    row[C_DQ] = i.d;
    row[C_DQ + 1] = i.q;
    recording_voltage(r, k, &row[C_U]);
    row[C_SPEED] = per_speed * r->omega_e_rad_s[k];
}

/* A row without values separates two stretches. A run whose time begins again follows the one before. */
static void fill(const recording *r, double per_speed, chart_data *d)
{
    double shift_s = 0.0;
    double last_s = 0.0;
    for (size_t n = 0; n < r->stretches; n++) {
        const stretch *const s = &r->stretch[n];
        double row[COLUMNS];
        if (n > 0) {
            shift_s = fmax(shift_s, last_s + r->T_s - r->t_s[s->first]);
            for (int x = 0; x < COLUMNS; x++) {
                row[x] = NAN;
            }
            row[C_T] = last_s + 0.5 * r->T_s;
            chart_data_add(d, row);
        }
        for (size_t k = s->first; k < s->first + s->count; k++) {
            last_s = r->t_s[k] + shift_s;
            row[C_T] = last_s;
            fill_row(r, k, per_speed, row);
            chart_data_add(d, row);
        }
    }
}

static bool draw(page *p, const chart_data *d, bool rpm, error *e)
{
    static const char *const label[] = {"a", "b", "c"};
    static const chart_colour colour[] = {CHART_BLUE, CHART_ORANGE, CHART_GREEN};
    const chart usual = {.x_label = "time, s", .group = "recording", .height = 210};
    chart drawn[4] = {usual, usual, usual, usual};
    drawn[0].y_label = "phase currents, A";
    drawn[1].y_label = "i_d and i_q, A";
    drawn[2].y_label = "phase voltages, V";
    drawn[3].y_label = rpm ? "speed, rpm" : "electrical speed, Hz";
    for (size_t x = 0; x < 3; x++) {
        drawn[0].series[x] =
            (chart_series){.label = label[x], .data = d, .column = C_PHASE + x, .colour = colour[x]};
        drawn[2].series[x] =
            (chart_series){.label = label[x], .data = d, .column = C_U + x, .colour = colour[x]};
    }
    drawn[1].series[0] = (chart_series){.label = "i_d", .data = d, .column = C_DQ, .colour = CHART_BLUE};
    drawn[1].series[1] =
        (chart_series){.label = "i_q", .data = d, .column = C_DQ + 1, .colour = CHART_ORANGE};
    drawn[3].series[0] = (chart_series){.label = "speed", .data = d, .column = C_SPEED, .colour = CHART_BLUE};
    return page_charts(p, drawn, 4, "recording",
                       "Samples at the start of each control cycle; voltages are the commanded means.", e);
}

/* Begins a page at a path. */
static bool begin_at(page *p, const char *path, const char *title, const char *subtitle, error *e)
{
    const char *slash = strrchr(path, '/');
    char directory[sizeof p->directory] = ".";
    const size_t parent = slash != NULL ? (size_t)(slash - path) + (slash == path ? 1 : 0) : 0;
    if (parent >= sizeof directory) {
        return error_input(e, path, 0, 0, "too long a name for a file");
    }
    if (slash != NULL) {
        (void)snprintf(directory, sizeof directory, "%.*s", (int)parent, path);
    }
    return page_begin_as(p, directory, slash != NULL ? slash + 1 : path, title, subtitle, e);
}

static bool plot_page(const recording *r, const motor *m, const char *path, error *e)
{
    page p;
    char title[200];
    chart_data d = chart_data_of(COLUMNS);
    (void)snprintf(title, sizeof title, "Recording %s", r->path);
    fill(r, 1.0 / (m != NULL ? motor_speed_rad_s(m, 1.0) : VEC_TWO_PI), &d);
    bool ok = begin_at(&p, path, title, m != NULL ? m->name : "", e);
    if (ok) {
        page_lead(&p, "%zu rows, control cycle %.6g us.", r->rows, 1e6 * r->T_s);
        ok = page_finish(&p, draw(&p, &d, m != NULL, e), e);
    }
    chart_data_free(&d);
    return ok;
}

static bool plot_recording(const char *path, error *e)
{
    motor m;
    recording r;
    if ((motor_path != NULL && !motor_read(motor_path, &m, e)) || !recording_read(path, &r, e)) {
        return false;
    }
    const bool ok = plot_page(&r, motor_path != NULL ? &m : NULL, output, e);
    recording_free(&r);
    if (ok) {
        printf("page: %s\n", output);
    }
    return ok;
}

int cmd_plot(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_plot, argc, argv);
    const bool ok = options_read(&o, &e) &&
                    (o.helped || ((output != NULL || options_missing(&o, "output", &e)) &&
                                  options_recording(&o, &e) && plot_recording(o.argv[o.first], &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

/* 2019: Figs. 7 and 9 (figures_2019_speed.h). */
#include "figures_2019_speed.h"

#include "lab_drives.h"
#include "paper_2019.h"
#include "rows_page.h"
#include "sweep.h"

#include <math.h>
#include <stdlib.h>

static const double highest_rpm = 8000.0;
static const double lowest_rpm = 500.0;

enum { SPEEDS = 24 };

/* Speeds whose ratios lie evenly on a logarithmic axis from 12.5 to 200. */
static double speed_at(int n)
{
    return highest_rpm * pow(lowest_rpm / highest_rpm, (double)n / (SPEEDS - 1));
}

/* A chart's x rises: from the highest speed to the lowest. The columns are SFFR and the methods' errors. */
static bool sweep_of(const motor *m, const method_machine *machine, bool weakened, chart_data *d, error *e)
{
    *d = chart_data_of(1 + METHOD_COUNT);
    for (int n = 0; n < SPEEDS; n++) {
        const double rpm = speed_at(n);
        sweep_point at;
        if (!sweep_point_at(m, machine, rpm,
                            weakened ? paper_2019_current(m, rpm) : paper_2019_current_at(m, 0.0), &at, e)) {
            return false;
        }
        double row[1 + METHOD_COUNT] = {at.sffr};
        for (int k = 0; k < METHOD_COUNT; k++) {
            row[1 + k] = at.errors.of[k].rms_percent;
        }
        chart_data_add(d, row);
    }
    return true;
}

static int by_first(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static void sort_rows(chart_data *d)
{
    if (d->rows > 0) {
        qsort(d->value, d->rows, d->columns * sizeof *d->value, by_first);
    }
}

static chart_data table_1_of(const motor *m)
{
    chart_data d = chart_data_of(1 + METHOD_COUNT);
    for (int n = 0; n < PAPER_2019_TABLE_1; n++) {
        double row[1 + METHOD_COUNT] = {paper_2019_sffr(m, paper_2019_table_1[n].n_rpm)};
        for (int k = 0; k < METHOD_COUNT; k++) {
            row[1 + k] = paper_2019_table_1[n].percent[k];
        }
        chart_data_add(&d, row);
    }
    sort_rows(&d);
    return d;
}

static chart_data measured_of(const motor *m)
{
    chart_data d = chart_data_of(3);
    for (int n = 0; n < PAPER_2019_TABLE_3; n++) {
        const struct paper_2019_measured *at = &paper_2019_table_3[n];
        chart_data_add(&d, (double[]){paper_2019_sffr(m, at->n_rpm), at->standard, at->quasi_discrete});
    }
    sort_rows(&d);
    return d;
}

/* What Fig. 7 is drawn from. */
typedef struct figure_7_data {
    chart_data errors, plain, paper;
} figure_7_data;

static chart error_chart(const figure_7_data *f, size_t column, const char *title, bool logarithmic)
{
    return (chart){
        .title = title,
        .x_label = "SFFR",
        .y_label = "error, % of the rms current",
        .x = {.logarithmic = logarithmic,
              .fixed = true,
              .low = logarithmic ? 11.5 : 10.0,
              .high = logarithmic ? 220.0 : 50.0},
        .y = {.logarithmic = logarithmic},
        .series = {
            {"standard", &f->errors, column, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false},
            {"quasi-discrete", &f->errors, column + 1, CHART_ORANGE, CHART_LINE, CHART_ALWAYS, 0.0, false},
            {"paper, standard", &f->paper, column, CHART_BLUE, CHART_POINTS, CHART_ALWAYS, 0.0, false},
            {"paper, quasi-discrete", &f->paper, column + 1, CHART_ORANGE, CHART_POINTS, CHART_ALWAYS, 0.0,
             false},
            {"standard, i_d = 0", &f->plain, column, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0, true},
            {"quasi-discrete, i_d = 0", &f->plain, column + 1, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0,
             true}}};
}

static bool draw_figure_7(page *p, const figure_7_data *f, error *e)
{
    const chart drawn[] = {error_chart(f, 1, "(a) mean current", false),
                           error_chart(f, 3, "(b) prediction", false)};
    const chart wide[] = {error_chart(f, 1, "(a) mean current", true),
                          error_chart(f, 3, "(b) prediction", true)};
    return page_charts(p, drawn, 2, "2019-figure-7",
                       "Figure 7. Errors over the switching-to-fundamental frequency ratio (SFFR), rated "
                       "current: mean "
                       "current (a), prediction (b). Dots: the paper's Table 1.",
                       e) &&
           page_charts(p, wide, 2, "2019-figure-7-log",
                       "The same down to 500 rpm, both axes logarithmic. The paper's standard figures at "
                       "SFFR 200 lie on "
                       "the curve of SFFR 100.",
                       e);
}

bool figure_2019_7(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e)
{
    figure_7_data f = {.paper = table_1_of(m)};
    page_heading(p, 3, "Errors over speed");
    page_pair_begin(p);
    const bool ok = sweep_of(m, machine, true, &f.errors, e) && sweep_of(m, machine, false, &f.plain, e) &&
                    draw_figure_7(p, &f, e);
    chart_data_free(&f.errors);
    chart_data_free(&f.plain);
    chart_data_free(&f.paper);
    if (!ok) {
        return false;
    }
    page_pair_beside(p);
    rows_page_table(p, c, "2019", "Table 1", NULL);
    page_pair_end(p);
    return true;
}

static bool spread_of(const motor *m, method which, chart_data *d, error *e)
{
    *d = chart_data_of(4);
    for (int n = 0; n < SPEEDS; n++) {
        const double rpm = speed_at(n);
        steady_drive at;
        lab_spread s;
        if (rpm < 1900.0) {
            continue; /* outside the figure */
        }
        if (!steady_drive_run(m, rpm, paper_2019_current(m, rpm), 100, &at, e)) {
            return false;
        }
        const bool ok = lab_spread_of(m, &at, which, &s, e);
        steady_drive_free(&at);
        if (!ok) {
            return false;
        }
        chart_data_add(d, (double[]){1.0 / at.turns_per_cycle, s.low, s.median, s.high});
    }
    return true;
}

static bool draw_figure_9(page *p, const comparison *c, const chart_data spread[2], const chart_data *errors,
                          const chart_data *measured, error *e)
{
    chart drawn[2];
    for (size_t k = 0; k < 2; k++) {
        drawn[k] = (chart){
            .title = k == 0 ? "(a) standard" : "(b) quasi-discrete",
            .x_label = "SFFR",
            .y_label = "prediction, % of the rms current",
            .x = {.fixed = true, .low = 10.0, .high = 50.0},
            .series = {
                {"90 % of drives, from", &spread[k], 1, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0, true},
                {"to", &spread[k], 3, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 0.0, true},
                {"their median", &spread[k], 2, CHART_ORANGE, CHART_LINE, CHART_ALWAYS, 0.0, false},
                {"simulation", errors, 3 + k, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0, false},
                {"measured", measured, 1 + k, CHART_PURPLE, CHART_POINTS, CHART_ALWAYS, 0.0, false}}};
    }
    return rows_page_charts(p, drawn, 2, "2019-figure-9",
                            "Figure 9. Prediction errors as they might be measured, and the two points that "
                            "the paper gives in numbers (Table 3).",
                            c, "2019", "Table 3", NULL, e);
}

bool figure_2019_9(page *p, const comparison *c, const motor *m, const method_machine *machine, error *e)
{
    chart_data errors = {0};
    chart_data spread[2] = {{0}, {0}};
    chart_data measured = measured_of(m);
    page_heading(p, 3, "In place of the laboratory");
    page_text(p,
              "The paper does not give the laboratory's noise and parameter errors. %d drives are drawn "
              "(seed %d) whose controllers have R within ±10 %%, L to ±5 %%, ψ to ±2 %%, the "
              "voltage to ±1 %% and the angle to ±1° (each uniform), with 0.5 %% of the rated peak as "
              "noise on each current sample. Nothing is fitted to the measured points.",
              LAB_DRAWS, (int)LAB_SEED);
    const bool ok = sweep_of(m, machine, true, &errors, e) &&
                    spread_of(m, METHOD_PREDICTION_STANDARD, &spread[0], e) &&
                    spread_of(m, METHOD_PREDICTION_QUASI_DISCRETE, &spread[1], e) &&
                    draw_figure_9(p, c, spread, &errors, &measured, e);
    chart_data_free(&errors);
    chart_data_free(&spread[0]);
    chart_data_free(&spread[1]);
    chart_data_free(&measured);
    return ok;
}

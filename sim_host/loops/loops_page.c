/* The study as a report page (loops_study.h). */
#include "loops_study.h"

#include "report/page.h"
#include "run_up_show.h"

#include <stdlib.h>

/* ---- Six-step ---- */

enum { THIN = 6 }; /* every sixth interval, and thus the same state of the inverter, which hides the ripple */

static chart_data six_step_trace(const six_step_loop *l)
{
    chart_data d = chart_data_of(3);
    for (int k = SIX_STEP_STEP_AT - 300; k < SIX_STEP_INTERVALS; k += THIN) {
        chart_data_add(&d, (double[]){l->trace_t_s[k], l->trace_q_A[k],
                                      k < SIX_STEP_STEP_AT ? l->reference_before_A : l->reference_A});
    }
    return d;
}

static bool six_step_figure(page *p, const loops_study *s, error *e)
{
    chart_data discrete = six_step_trace(&s->six_step[SIX_STEP_DISCRETE]);
    chart_data corrected = six_step_trace(&s->six_step[SIX_STEP_CORRECTED]);
    const chart drawn = {
        .x_label = "t, s",
        .y_label = "i_q, A",
        .height = 340,
        .series = {{"reference", &corrected, 2, CHART_FAINT, CHART_LINE, CHART_ALWAYS, 2.0, false},
                   {"true, discrete angle fed back", &discrete, 1, CHART_ORANGE, CHART_LINE, CHART_ALWAYS,
                    0.0, false},
                   {"true, corrected mean fed back", &corrected, 1, CHART_BLUE, CHART_LINE, CHART_ALWAYS, 0.0,
                    false}}};
    const bool ok = page_chart(p, &drawn, "loops-six-step",
                               "Six-step torque control: the true mean of i_q over each inverter state. In "
                               "both controllers the feedback equals the reference.",
                               e);
    chart_data_free(&discrete);
    chart_data_free(&corrected);
    return ok;
}

static bool six_step_part(page *p, const loops_study *s, error *e)
{
    static const char *const heads[] = {"feedback",    "\tfed back, A", "\ttrue i_q, A",
                                        "\texcess, %", "\ttorque, Nm",  "\tasked for, Nm"};
    page_heading(p, 2, "Six-step torque control");
    page_lead(p, "Excess of the true current: %.2f %% with the discrete angle, %.2f %% corrected.",
              six_step_excess_percent(&s->six_step[SIX_STEP_DISCRETE]),
              six_step_excess_percent(&s->six_step[SIX_STEP_CORRECTED]));
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int n = 0; n < SIX_STEP_LOOPS; n++) {
        const six_step_loop *l = &s->six_step[n];
        page_row_begin(p);
        page_cell(p, false, "%s", six_step_loop_text[n]);
        page_cell(p, true, "%.4f", l->i_q_fed_back_A);
        page_cell(p, true, "%.4f", l->i_q_A);
        page_cell(p, true, "%.3f", six_step_excess_percent(l));
        page_cell(p, true, "%.4f", l->torque_Nm);
        page_cell(p, true, "%.4f", l->torque_reference_Nm);
        page_row_end(p);
    }
    page_table_end(p);
    return six_step_figure(p, s, e);
}

/* ---- Current loops ---- */

static double curve_ratio(const loops_study *s, loop_method how, int k, double *x)
{
    *x = loop_ratios[k];
    return s->current.at[k][LOOP_NOMINAL][how].rms_percent;
}

enum { STEP_RATIO = 3 }; /* SFFR 10 */

static double curve_step(const loops_study *s, loop_method how, int k, double *x)
{
    *x = k - LOOP_TRACE_BEFORE;
    return s->current.at[STEP_RATIO][LOOP_NOMINAL][how].trace_q[k];
}

/* The firmware begins while the machine turns at full speed. */
static double curve_start(const loops_study *s, loop_method how, int k, double *x)
{
    *x = k;
    return s->current.at[STEP_RATIO][LOOP_NOMINAL][how].trace_start[k];
}

/* A figure with a curve of each of some methods. */
typedef struct method_figure {
    double (*curve)(const loops_study *s, loop_method how, int k, double *x);
    int points;
    const loop_method *drawn;
    int count;
    chart axes;
    const char *id, *caption;
} method_figure;

static bool draw_methods(page *p, const loops_study *s, const method_figure *f, error *e)
{
    /* A predictor has the same colour with and without observer; PI with the mid-point sample is faint. */
    static const chart_colour colours[] = {CHART_FAINT, CHART_BLUE, CHART_ORANGE, CHART_GREEN, CHART_PURPLE};
    chart_data d = chart_data_of(1 + (size_t)f->count);
    chart drawn = f->axes;
    for (int k = 0; k < f->points; k++) {
        double row[1 + CHART_SERIES];
        for (int n = 0; n < f->count; n++) {
            row[1 + n] = f->curve(s, f->drawn[n], k, &row[0]);
        }
        chart_data_add(&d, row);
    }
    for (size_t n = 0; n < (size_t)f->count; n++) {
        const int how = (int)f->drawn[n];
        drawn.series[n] = (chart_series){
            loop_method_text[how], &d,           1 + n, colours[how < LOOP_LEARNING_EULER ? how : how - 3],
            CHART_LINE_POINTS,     CHART_ALWAYS, 0.0,   false};
    }
    const bool ok = page_chart(p, &drawn, f->id, f->caption, e);
    chart_data_free(&d);
    return ok;
}

static bool method_figures(page *p, const loops_study *s, error *e)
{
    /* Loops with observer have the exact predictor's steady state. */
    static const loop_method steady[] = {LOOP_PI_MIDPOINT, LOOP_PI_MEAN, LOOP_DEADBEAT_EULER,
                                         LOOP_DEADBEAT_QUASI_DISCRETE, LOOP_DEADBEAT_EXACT};
    static const loop_method starting[] = {LOOP_PI_MEAN, LOOP_LEARNING_EULER, LOOP_LEARNING_QUASI_DISCRETE,
                                           LOOP_LEARNING_EXACT};
    static const method_figure figures[] = {
        {curve_ratio,
         LOOP_RATIOS,
         steady,
         5,
         {.x_label = "switching over fundamental frequency",
          .y_label = "rms error, % of rated",
          .x = {.logarithmic = true, .fixed = true, .low = 4.8, .high = 52.0},
          .y = {.logarithmic = true},
          .height = 380},
         "loops-error",
         "Steady error of the true mean current, correct parameters. All loops share the beat of the PWM's "
         "ripple with the rotor."},
        {curve_step,
         LOOP_TRACE_CYCLES,
         steady,
         5,
         {.x_label = "cycles after the step of the reference", .y_label = "i_q over rated", .height = 360},
         "loops-step",
         "Step of i_q from 0.3 to 0.7 of rated at SFFR 10, correct parameters: the true mean of each cycle."},
        {curve_start,
         LOOP_TRACE_CYCLES,
         starting,
         4,
         {.x_label = "cycles after switch-on",
          .y_label = "error, % of rated",
          .y = {.logarithmic = true},
          .height = 360},
         "loops-start",
         "Switched on at full speed, at SFFR 10. The disturbance estimate starts at zero. In the first cycle "
         "the terminals are shorted in every loop."}};
    bool ok = true;
    for (size_t n = 0; n < sizeof figures / sizeof figures[0] && ok; n++) {
        ok = draw_methods(p, s, &figures[n], e);
    }
    return ok;
}

static void rms_cell(page *p, const loop_result *r)
{
    if (r->outcome == LOOP_TRIPS) {
        page_cell(p, true, "trips");
    } else {
        page_cell(p, true, "%.3g%s", r->rms_percent, r->outcome == LOOP_UNSTABLE ? "*" : "");
    }
}

static const int tabled[] = {0, 3, 6, 8}; /* ratios 5, 10, 20, 50; the JSON has all */

static void belief_table(page *p, const loops_study *s)
{
    static const char *const heads[] = {"\tSFFR",    "loop",      "\tright", "\tL +30", "\tL -30",
                                        "\tpsi +10", "\tpsi -10", "\tR +50", "\tR -50", "\tnoise"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (size_t t = 0; t < sizeof tabled / sizeof tabled[0]; t++) {
        const int k = tabled[t];
        for (int n = 0; n < LOOP_METHODS; n++) {
            page_row_begin(p);
            page_cell(p, true, "%g", loop_ratios[k]);
            page_cell(p, false, "%s", loop_method_text[n]);
            for (int b = 0; b < LOOP_BELIEFS; b++) {
                rms_cell(p, &s->current.at[k][b][n]);
            }
            rms_cell(p, &s->current.noisy[k][n]);
            page_row_end(p);
        }
    }
    page_table_end(p);
    page_note(p, "rms error in percent of the rated peak. Columns: error of the firmware's parameter in "
                 "percent. noise: 0.5 %% of the rated peak on each sample, correct parameters. *: unstable, "
                 "varies by more than 5 %%. trips: beyond three times rated.");
}

static bool current_part(page *p, const loops_study *s, error *e)
{
    const loop_result *at = s->current.at[0][LOOP_NOMINAL];
    page_heading(p, 2, "Deadbeat control with each predictor, against PI");
    page_lead(p,
              "Error of plain deadbeat control at SFFR %g, in percent of rated: Euler predictor %.3g %%, "
              "quasi-discrete %.3g %%, exact %.3g %%.",
              loop_ratios[0], at[LOOP_DEADBEAT_EULER].rms_percent,
              at[LOOP_DEADBEAT_QUASI_DISCRETE].rms_percent, at[LOOP_DEADBEAT_EXACT].rms_percent);
    if (!method_figures(p, s, e)) {
        return false;
    }
    page_heading(p, 3, "With wrong parameters");
    belief_table(p, s);
    return true;
}

/* ---- Finite set ---- */

/* Pulses a second and distortion of some loops, the pulses rising. */
static void add_trade(chart_data *d, const loop_result *r)
{
    chart_data_add(d, (double[]){r->switching_Hz, r->thd_percent});
}

static int by_first(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool trade_figure(page *p, const loops_study *s, error *e)
{
    enum { CURVES = IQFOC_FINITE_SET_HORIZON + 1 };
    static const char *const labels[CURVES] = {"finite set, horizon 1", "horizon 2", "horizon 3",
                                               "deadbeat with PWM"};
    static const chart_colour colours[CURVES] = {CHART_BLUE, CHART_ORANGE, CHART_GREEN, CHART_PURPLE};
    const finite_set_loops *all = &s->finite_set;
    chart_data d[CURVES];
    chart drawn = {.x_label = "pulses per leg and second", .y_label = "THD of the current, %", .height = 360};
    page_heading(p, 2, "Finite-set control");
    for (int n = 0; n < CURVES; n++) {
        d[n] = chart_data_of(2);
        for (int w = 0; w < FINITE_SET_WEIGHTS; w++) {
            if (n < IQFOC_FINITE_SET_HORIZON) {
                add_trade(&d[n], &all->trade[n][w].loop);
            } else if (all->pwm_ratio[w] > 0.0) {
                add_trade(&d[n], &all->pwm[w]);
            }
        }
        if (d[n].rows > 0) {
            qsort(d[n].value, d[n].rows, 2 * sizeof *d[n].value, by_first);
        }
        drawn.series[n] =
            (chart_series){labels[n], &d[n], 1, colours[n], CHART_LINE_POINTS, CHART_ALWAYS, 0.0, false};
    }
    const bool ok = page_chart(p, &drawn, "loops-finite-set",
                               "Distortion over switching for rising weights on switching, exact predictor, "
                               "100 control intervals per period.",
                               e);
    for (int n = 0; n < CURVES; n++) {
        chart_data_free(&d[n]);
    }
    return ok;
}

bool loops_study_page(const loops_study *s, const char *directory, error *e)
{
    page p;
    if (!page_begin(&p, directory, "Closed-loop study",
                    "Error, settling and stability of the firmware's controllers in IQ24 with the "
                    "switching-level drive of the 2019 paper.",
                    e)) {
        return false;
    }
    const bool ok = six_step_part(&p, s, e) && current_part(&p, s, e) && trade_figure(&p, s, e) &&
                    run_ups_part(&p, s->run_ups, e);
    corrected_loops_part(&p, &s->corrected);
    update_loops_part(&p, &s->updates);
    sensorless_loops_part(&p, &s->sensorless);
    return page_finish(&p, ok, e);
}

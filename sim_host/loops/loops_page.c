/* The study as a report page (loops_study.h). */
#include "loops_study.h"

#include "report/page.h"
#include "run_up_show.h"

#include <math.h>

/* ---- Six-step ---- */

enum { THIN = 6 }; /* every sixth interval, and thus the same state of the inverter, which hides the ripple */

static bool six_step_figure(page *p, const loops_study *s, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 720, 340, e)) {
        return false;
    }
    for (int n = 0; n < SIX_STEP_LOOPS; n++) {
        plot_data(&drawing, n == SIX_STEP_DISCRETE ? "discrete" : "corrected");
        for (int k = SIX_STEP_STEP_AT - 300; k < SIX_STEP_INTERVALS; k += THIN) {
            plot_say(&drawing, "%.6g %.6g %.6g %.6g\n", s->six_step[n].trace_t_s[k],
                     s->six_step[n].trace_q_A[k], s->six_step[n].trace_fed_back_A[k],
                     k < SIX_STEP_STEP_AT ? s->six_step[n].reference_before_A : s->six_step[n].reference_A);
        }
        plot_data_end(&drawing);
    }
    plot_say(&drawing, "set xlabel 't, s'\nset ylabel 'i_q, A'\nset key right bottom\n"
                       "plot $corrected using 1:4 with lines linestyle 9 linewidth 2 title 'reference', "
                       "$discrete using 1:2 with lines linestyle 2 title 'true, discrete angle fed back', "
                       "$corrected using 1:2 with lines linestyle 1 title 'true, corrected mean fed back'\n");
    return page_figure(p, &drawing, "loops-six-step",
                       "Six-step torque control: the true mean of i_q over each inverter state. Both "
                       "controllers believe that they hold the reference.",
                       e);
}

static bool six_step_part(page *p, const loops_study *s, error *e)
{
    static const char *const heads[] = {"feedback",    "\tfed back, A", "\ttrue i_q, A",
                                        "\texcess, %", "\ttorque, Nm",  "\tasked for, Nm"};
    page_heading(p, 2, "Six-step torque control");
    page_lead(
        p,
        "Fed by the discrete angle the drive carries %.2f %% more current than was asked for, corrected "
        "%.2f %%.",
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
    const char *point_size;
    const loop_method *drawn;
    int count, height;
    const char *axes, *id, *caption;
} method_figure;

static bool draw_methods(page *p, const loops_study *s, const method_figure *f, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 720, f->height, e)) {
        return false;
    }
    for (int n = 0; n < f->count; n++) {
        plot_data(&drawing, loop_method_key[f->drawn[n]]);
        for (int k = 0; k < f->points; k++) {
            double x = 0.0;
            const double y = f->curve(s, f->drawn[n], k, &x);
            plot_say(&drawing, "%g %.5g\n", x, y);
        }
        plot_data_end(&drawing);
    }
    plot_say(&drawing, "%s\nplot ", f->axes);
    for (int n = 0; n < f->count; n++) {
        /* A predictor has the same style with and without learning; the plainest loop is faint. */
        const int how = (int)f->drawn[n];
        const int style = how == LOOP_PI_MIDPOINT ? 9 : how < LOOP_LEARNING_EULER ? how : how - 3;
        plot_say(&drawing, "%s$%s using 1:2 with linespoints linestyle %d %s title '%s'", n > 0 ? ", " : "",
                 loop_method_key[how], style, f->point_size, loop_method_text[how]);
    }
    plot_say(&drawing, "\n");
    return page_figure(p, &drawing, f->id, f->caption, e);
}

static bool method_figures(page *p, const loops_study *s, error *e)
{
    /* Those that learn are in steady state what the exact predictor is. */
    static const loop_method steady[] = {LOOP_PI_MIDPOINT, LOOP_PI_MEAN, LOOP_DEADBEAT_EULER,
                                         LOOP_DEADBEAT_QUASI_DISCRETE, LOOP_DEADBEAT_EXACT};
    static const loop_method starting[] = {LOOP_PI_MEAN, LOOP_LEARNING_EULER, LOOP_LEARNING_QUASI_DISCRETE,
                                           LOOP_LEARNING_EXACT};
    static const method_figure figures[] = {
        {curve_ratio, LOOP_RATIOS, "", steady, 5, 400,
         "set logscale xy\nset xrange [4.8:52]\nset xtics (5, 6, 8, 10, 12, 16, 20, 30, 50)\n"
         "set xlabel 'switching over fundamental frequency'\n"
         "set ylabel 'rms error, % of rated'\nset key right top",
         "loops-error",
         "Steady error of the true mean current, right parameters. The part that all share is the beat of "
         "the PWM's ripple with the turning rotor."},
        {curve_step, LOOP_TRACE_CYCLES, "pointsize 0.4", steady, 5, 380,
         "set xlabel 'cycles after the step of the reference'\n"
         "set ylabel 'i_q over rated'\nset key right bottom",
         "loops-step",
         "Step of i_q from 0.3 to 0.7 of rated at a ratio of 10, right parameters: the true mean of each "
         "cycle."},
        {curve_start, LOOP_TRACE_CYCLES, "pointsize 0.4", starting, 4, 360,
         "set logscale y\nset xlabel 'cycles after switch-on'\nset ylabel 'error, % of rated'\n"
         "set key right top",
         "loops-start",
         "Switched on at full speed, at a ratio of 10: what has to be learnt first is missing first. In the "
         "first cycle the terminals are shorted, for every loop alike."}};
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
    page_note(p, "rms error in percent of the rated peak; what the firmware believes against the truth, in "
                 "percent; noise of 0.5 %% of the rated peak on each sample, right parameters. *: unstable, "
                 "wandering by more than 5 %%. trips: beyond three times rated.");
}

static bool current_part(page *p, const loops_study *s, error *e)
{
    const loop_result *at = s->current.at[0][LOOP_NOMINAL];
    page_heading(p, 2, "Deadbeat control with each predictor, against PI");
    page_lead(p,
              "At a ratio of %g, plain deadbeat control misses its reference by %.3g %% of the rated current "
              "with "
              "the Euler predictor, by %.3g %% with the quasi-discrete and by %.3g %% with the exact one.",
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

static bool trade_figure(page *p, const loops_study *s, error *e)
{
    const finite_set_loops *all = &s->finite_set;
    plot drawing;
    page_heading(p, 2, "A finite set of states");
    if (!plot_begin(&drawing, 720, 380, e)) {
        return false;
    }
    for (int h = 0; h < IQFOC_FINITE_SET_HORIZON; h++) {
        char name[16];
        (void)snprintf(name, sizeof name, "horizon%d", h + 1);
        plot_data(&drawing, name);
        for (int w = 0; w < FINITE_SET_WEIGHTS; w++) {
            const loop_result *r = &all->trade[h][w].loop;
            plot_say(&drawing, "%.6g %.5g\n", r->switching_Hz, r->thd_percent);
        }
        plot_data_end(&drawing);
    }
    plot_data(&drawing, "pwm");
    for (int w = 0; w < FINITE_SET_WEIGHTS; w++) {
        if (all->pwm_ratio[w] > 0.0) {
            plot_say(&drawing, "%.6g %.5g\n", all->pwm[w].switching_Hz, all->pwm[w].thd_percent);
        }
    }
    plot_data_end(&drawing);
    plot_say(&drawing, "set xlabel 'pulses per leg and second'\nset ylabel 'THD of the current, %%'\n"
                       "set yrange [0:*]\nset key right top\nplot "
                       "$horizon1 using 1:2 with linespoints linestyle 1 title 'finite set, horizon 1', "
                       "$horizon2 using 1:2 with linespoints linestyle 2 title 'horizon 2', "
                       "$horizon3 using 1:2 with linespoints linestyle 3 title 'horizon 3', "
                       "$pwm using 1:2 with linespoints linestyle 4 title 'deadbeat with PWM'\n");
    return page_figure(p, &drawing, "loops-finite-set",
                       "Distortion over switching as the weight on switching is raised, exact predictor, 100 "
                       "control intervals a period.",
                       e);
}

bool loops_study_page(const loops_study *s, const char *directory, error *e)
{
    page p;
    if (!page_begin(&p, directory, "In the loop",
                    "What better feedback and better prediction do to a drive: the firmware's controllers in "
                    "IQ24 against the switching-level drive of the 2019 paper.",
                    e)) {
        return false;
    }
    const bool ok = six_step_part(&p, s, e) && current_part(&p, s, e) && trade_figure(&p, s, e) &&
                    run_ups_part(&p, s->run_ups, e);
    update_loops_part(&p, &s->updates);
    return page_finish(&p, ok, e);
}

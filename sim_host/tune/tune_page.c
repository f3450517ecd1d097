/* A design as a report page (tune_report.h). */
#include "tune_report.h"

#include "base/vector.h"
#include "report/page.h"

#include <math.h>

/* ---- Margins over speed ---- */

static bool margins_figure(page *p, const tune_result *r, error *e)
{
    plot drawing;
    if (!plot_begin(&drawing, 760, 560, e)) {
        return false;
    }
    plot_data(&drawing, "margins");
    for (int s = 0; s < TUNE_SPEEDS; s++) {
        const tune_at_speed *at = &r->at[s];
        plot_say(&drawing, "%g %g %g %g %g %g %g %g %g\n", at->rpm, at->worst.disk, at->nominal.disk,
                 at->worst.gain_dB, at->nominal.gain_dB, at->worst.phase_deg, at->nominal.phase_deg,
                 at->worst.delay_cycles, at->nominal.delay_cycles);
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set multiplot layout 2,2 margins 0.07,0.97,0.12,0.95 spacing 0.1,0.17\n"
             "set yrange [0:*]\nset xtics autofreq %g\n",
             r->motor.n_max_rpm / 4.0);
    static const char *const panels[] = {"disk margin", "gain margin, dB", "phase margin, degrees",
                                         "delay margin, cycles"};
    for (int n = 0; n < 4; n++) {
        plot_say(
            &drawing,
            "set title '%s'\n%s\n%s\nplot $margins using 1:%d with linespoints linestyle 1 pointsize 0.4 "
            "title "
            "'worst of the region', $margins using 1:%d with linespoints linestyle 2 pointsize 0.4 title "
            "'nominal'\n",
            panels[n], n == 0 ? "set key bottom left" : "unset key",
            n >= 2 ? "set xlabel 'rpm'" : "unset xlabel", 2 + 2 * n, 3 + 2 * n);
    }
    plot_say(&drawing, "unset multiplot\n");
    return page_figure(
        p, &drawing, "tune-margins",
        "How far the voltage may go wrong before the loop is unstable, over the speed. A delay margin "
        "of 1 stands for at least one cycle.",
        e);
}

static void margins_table(page *p, const tune_result *r)
{
    static const char *const heads[] = {
        "\trpm",        "\tSFFR",          "\tdisk margin",  "\tgain, dB",
        "\tphase, deg", "\tdelay, cycles", "\tlargest pole", "worst disk margin with"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int s = 0; s < TUNE_SPEEDS; s += 2) {
        const tune_at_speed *at = &r->at[s];
        page_row_begin(p);
        page_cell(p, true, "%.0f", at->rpm);
        page_cell(p, true, "%.3g", at->sffr);
        page_cell(p, true, "%.3f", at->worst.disk);
        page_cell(p, true, "%.2f", at->worst.gain_dB);
        page_cell(p, true, "%.1f", at->worst.phase_deg);
        page_cell(p, true, "%.2f", at->worst.delay_cycles);
        page_cell(p, true, "%.4f", at->radius_worst);
        page_cell(p, false, "%s", r->region.point[at->disk_worst].text);
        page_row_end(p);
    }
    page_table_end(p);
    page_note(
        p,
        "Each margin is the worst over the region, not all of one machine. The slowest pole is that of the "
        "valley's offset, which is learnt over twenty cycles.");
}

/* ---- Sensitivity ---- */

enum { FREQUENCIES = 120 };

static bool sensitivity_figure(page *p, const tune_result *r, error *e)
{
    static const int speeds[] = {0, (TUNE_SPEEDS - 1) / 2, TUNE_SPEEDS - 1};
    plot drawing;
    if (!plot_begin(&drawing, 760, 360, e)) {
        return false;
    }
    for (int n = 0; n < 3; n++) {
        const tune_at_speed *at = &r->at[speeds[n]];
        char name[16];
        tune_loop nominal;
        tune_loop worst;
        tune_loop_make(&r->design, &r->region.point[0].machine, at->phi_rad, &tune_no_fault, &nominal);
        tune_loop_make(&r->design, &r->region.point[at->disk_worst].machine, at->phi_rad, &tune_no_fault,
                       &worst);
        (void)snprintf(name, sizeof name, "speed%d", n);
        plot_data(&drawing, name);
        for (int k = 0; k < FREQUENCIES; k++) {
            const double w = VEC_PI * pow(10.0, 2.0 * ((double)(k + 1) / FREQUENCIES - 1.0));
            plot_say(&drawing, "%.5g %.5g %.5g\n", w * r->motor.f_pwm_Hz / VEC_TWO_PI,
                     tune_sensitivity(&nominal, w), tune_sensitivity(&worst, w));
        }
        plot_data_end(&drawing);
    }
    plot_say(&drawing,
             "set logscale xy\nset xlabel 'frequency in the rotor frame, Hz'\n"
             "set ylabel 'largest singular value'\nset key bottom right\nplot 1 with lines linestyle 9 "
             "notitle");
    for (int n = 0; n < 3; n++) {
        plot_say(&drawing,
                 ", $speed%d using 1:2 with lines linestyle %d dashtype 2 title 'nominal, %.0f rpm', "
                 "$speed%d using 1:3 "
                 "with lines linestyle %d title 'worst machine'",
                 n, n + 1, r->at[speeds[n]].rpm, n, n + 1);
    }
    plot_say(&drawing, "\n");
    return page_figure(
        p, &drawing, "tune-sensitivity",
        "Sensitivity of the voltage to a disturbance of it: below 1 the loop takes it away, above 1 it "
        "adds to it.",
        e);
}

/* ---- Steps and comparison ---- */

static bool steps_figure(page *p, const tune_report *t, error *e)
{
    static const int drawn[] = {0, 2, 3, 4}; /* ratios 5, 10, 20, 50 */
    const tune_comparison *c = &t->comparison;
    plot drawing;
    if (!plot_begin(&drawing, 760, 560, e)) {
        return false;
    }
    for (int n = 0; n < 4; n++) {
        char name[16];
        (void)snprintf(name, sizeof name, "ratio%d", n);
        plot_data(&drawing, name);
        for (int k = 0; k < LOOP_TRACE_CYCLES - 12; k++) {
            plot_say(&drawing, "%d", k - LOOP_TRACE_BEFORE);
            for (int how = 0; how < TUNE_CONTROLLERS; how++) {
                plot_say(&drawing, " %.5g", c->at[drawn[n]][how][0].trace_q[k]);
            }
            plot_say(&drawing, "\n");
        }
        plot_data_end(&drawing);
    }
    plot_say(&drawing, "set multiplot layout 2,2 margins 0.07,0.97,0.12,0.95 spacing 0.09,0.17\nset yrange "
                       "[0.2:1]\nset xrange [-4:28]\n");
    for (int n = 0; n < 4; n++) {
        if (!c->held[drawn[n]]) {
            plot_say(&drawing, "set title '%g cycles a turn: not held'\nunset key\nplot -1 notitle\n",
                     tune_ratios[drawn[n]]);
            continue;
        }
        plot_say(&drawing,
                 "set title '%g cycles a turn'\n%s\n%s\nplot $ratio%d using 1:2 with linespoints linestyle 9 "
                 "pointsize 0.3 "
                 "title '%s', $ratio%d using 1:5 with linespoints linestyle 1 pointsize 0.4 title '%s', "
                 "$ratio%d using "
                 "1:6 with linespoints linestyle 2 pointsize 0.4 title '%s'\n",
                 tune_ratios[drawn[n]], n == 3 ? "set key bottom right" : "unset key",
                 n >= 2 ? "set xlabel 'cycles after the step'" : "unset xlabel", n, tune_controller_text[0],
                 n, tune_controller_text[3], n, tune_controller_text[4]);
    }
    plot_say(&drawing, "unset multiplot\n");
    return page_figure(
        p, &drawing, "tune-steps",
        "Step of i_q from 0.3 to 0.7 of the rated peak, nominal machine, switching-level drive and "
        "firmware in fixed point: the true mean of each cycle.",
        e);
}

static void result_cells(page *p, const loop_result *l)
{
    if (l->outcome == LOOP_TRIPS) {
        page_cell(p, true, "trips");
        page_cell(p, true, "-");
        page_cell(p, true, "-");
        return;
    }
    page_cell(p, true, "%.3g%s", l->rms_percent, l->outcome == LOOP_UNSTABLE ? "*" : "");
    page_cell(p, true, "%.3g", l->overshoot_percent);
    if (l->outcome == LOOP_HOLDS) {
        page_cell(p, true, "%d", l->settling_beside_cycles);
    } else {
        page_cell(p, true, "-");
    }
}

static void comparison_table(page *p, const tune_comparison *c)
{
    static const char *const heads[] = {"\tSFFR",        "controller",   "\tnominal: rms", "\tovershoot",
                                        "\tsettling",    "\tL low: rms", "\tovershoot",    "\tsettling",
                                        "\tL high: rms", "\tovershoot",  "\tsettling"};
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    for (int k = 0; k < TUNE_RATIOS - 1; k++) {
        for (int n = 0; n < TUNE_CONTROLLERS && c->held[k]; n++) {
            page_row_begin(p);
            page_cell(p, true, "%g", tune_ratios[k]);
            page_cell(p, false, "%s", tune_controller_text[n]);
            for (int truth = 0; truth < TUNE_TRUTHS; truth++) {
                result_cells(p, &c->at[k][n][truth]);
            }
            page_row_end(p);
        }
    }
    page_table_end(p);
    page_note(p,
              "%.0f rpm; the switching frequency makes the ratio. True inductance nominal, %.0f %% lower and "
              "higher; all "
              "controllers but the last believe the nominal one. rms error in percent of the rated peak, "
              "overshoot in "
              "percent of the step, settling in cycles to within 5 %% of the rated peak beside what remains. "
              "*: unstable.",
              c->rpm, 100.0 * c->L_share);
}

static bool parts(page *p, const tune_report *t, error *e)
{
    const tune_result *r = &t->result;
    const tune_trial *trial = &t->trial;
    page_lead(p, "Bandwidth %.0f rad/s at %g Hz, limited by %s.", r->bandwidth_rad_s, r->motor.f_pwm_Hz,
              r->limited_by);
    page_text(
        p, "Region: %s, by %d machines at %d speeds. Put IQFOC_TUNED_LAW of iqfoc_tuned.h into the firmware.",
        r->region.source, r->region.points, TUNE_SPEEDS);
    page_heading(p, 2, "Margins over speed");
    if (!margins_figure(p, r, e)) {
        return false;
    }
    margins_table(p, r);
    if (!sensitivity_figure(p, r, e)) {
        return false;
    }
    page_heading(p, 2, "Tried");
    page_lead(p,
              "%d drives of the region, each at a speed of its own up to %.0f rpm: %d unstable, %d settled "
              "later than "
              "promised, %d overshot by more.",
              trial->drives, trial->rpm_most, trial->unstable, trial->late, trial->high);
    page_text(p,
              "The worst of them was promised an overshoot of %.1f %% and %.0f cycles to settle; found were "
              "%.1f %% and "
              "%.0f. No drive's overshoot was off its promise by more than %.1f %% of the step.",
              trial->promised.overshoot_percent, trial->promised.settling_cycles,
              trial->found.overshoot_percent, trial->found.settling_cycles, trial->overshoot_off);
    page_heading(p, 2, "Beside other controllers");
    if (!steps_figure(p, t, e)) {
        return false;
    }
    comparison_table(p, &t->comparison);
    return true;
}

bool tune_report_page(const tune_report *t, const char *directory, error *e)
{
    page p;
    char title[200];
    (void)snprintf(title, sizeof title, "%s, tuned", t->result.motor.name);
    if (!page_begin(&p, directory, title, "A current controller with the margins it has at every speed.",
                    e)) {
        return false;
    }
    return page_finish(&p, parts(&p, t, e), e);
}

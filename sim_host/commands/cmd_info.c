/* iqfoc info: what a recording holds: rows, rate, runs, speeds, currents and columns. */
#include "base/vector.h"
#include "command.h"
#include "data/motor.h"
#include "data/recording_columns.h"

#include <math.h>
#include <stdio.h>

static const char *motor_path;

static const option_spec specs[] = {{"motor", 'm', "M.toml",
                                     "the motor file: speeds in rpm, currents as a share of the rated peak",
                                     .text = &motor_path},
                                    {.name = NULL}};

const command_about about_info = {
    "info", "REC.csv [--motor M.toml]",
    "Prints what a recording holds: rows, control cycle, columns, and for each run its duration, speed,\n"
    "SFFR (PWM periods per electrical period) and current. Two lines of bars show speed and current over\n"
    "the rows.",
    specs};

/* ---- Columns ---- */

static void print_columns(const recording *r)
{
    recording all = *r;
    printf("  columns:");
    for (int id = COL_RUN; id < COL_COUNT; id++) {
        const bool there = id == COL_RUN     ? r->run != NULL
                           : id == COL_I_C   ? r->i_c_measured
                           : id == COL_OMEGA ? !r->omega_derived
                                             : *recording_column(&all, (column_id)id) != NULL;
        printf("%s%s", there ? " " : "", there ? recording_column_name((column_id)id) : "");
    }
    printf("\n%s%s", r->i_c_measured ? "" : "  i_c_A is computed from the other two\n",
           r->omega_derived ? "  omega_e_rad_s is computed as the slope of theta_e_rad\n" : "");
}

/* ---- Runs ---- */

typedef struct run_summary {
    size_t rows;
    double seconds, speed, current, most; /* sums until they are printed */
} run_summary;

static double current_of(const recording *r, size_t k)
{
    const vec_ab i = recording_current(r, k);
    return hypot(i.alpha, i.beta);
}

static void add_stretch(const recording *r, const stretch *s, run_summary *of)
{
    for (size_t k = s->first; k < s->first + s->count; k++) {
        const double i = current_of(r, k);
        of->speed += r->omega_e_rad_s[k];
        of->current += i * i;
        of->most = fmax(of->most, i);
    }
    of->rows += s->count;
    of->seconds += (double)s->count * r->T_s;
}

static void print_run(long run, const run_summary *s, double T_s, const motor *m)
{
    const double rows = (double)s->rows;
    const double speed = s->speed / rows;
    const double turns = fabs(speed) * T_s / VEC_TWO_PI;
    const double rms = sqrt(s->current / rows);
    printf("  %4ld %8zu %9.3f", run, s->rows, s->seconds);
    printf(m != NULL ? " %12.0f" : " %12.2f",
           m != NULL ? speed / motor_speed_rad_s(m, 1.0) : speed / VEC_TWO_PI);
    if (turns > 1e-4) {
        printf(" %8.1f", 1.0 / turns);
    } else {
        printf(" %8s", "-");
    }
    printf(" %9.4g %9.4g", rms, s->most);
    if (m != NULL) {
        printf(" %9.0f", 100.0 * s->most / motor_rated_peak_A(m));
    }
    putchar('\n');
}

/* Stretches of one run follow each other; a run without a number is one stretch. */
static void print_runs(const recording *r, const motor *m)
{
    printf("\n  %4s %8s %9s %12s %8s %9s %9s", "run", "rows", "s", m != NULL ? "speed, rpm" : "electric, Hz",
           "SFFR", "rms, A", "peak, A");
    printf("%s\n", m != NULL ? "  of rated, %" : "");
    for (size_t n = 0; n < r->stretches;) {
        run_summary s = {0};
        const long run = r->stretch[n].run;
        for (; n < r->stretches && r->stretch[n].run == run; n++) {
            add_stretch(r, &r->stretch[n], &s);
        }
        print_run(run, &s, r->T_s, m);
    }
}

/* ---- Bars ---- */

enum { BARS = 64, HEIGHTS = 8 };

static double speed_of(const recording *r, size_t k)
{
    return r->omega_e_rad_s[k] / VEC_TWO_PI;
}

static void print_bars(const recording *r, const char *name, double (*value)(const recording *r, size_t k))
{
    double mean[BARS];
    const size_t bars = r->rows < BARS ? r->rows : BARS;
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t n = 0; n < bars; n++) {
        const size_t first = n * r->rows / bars;
        const size_t end = (n + 1) * r->rows / bars;
        double sum = 0.0;
        for (size_t k = first; k < end; k++) {
            sum += value(r, k);
        }
        mean[n] = sum / (double)(end - first);
        low = fmin(low, mean[n]);
        high = fmax(high, mean[n]);
    }
    printf("  %-12s ", name);
    for (size_t n = 0; n < bars; n++) {
        const double share = high > low ? (mean[n] - low) / (high - low) : 0.0;
        /* UTF-8 of U+2581 ... U+2588, eighths of a block. */
        printf("\xe2\x96%c", (char)(0x81 + (int)fmin(HEIGHTS - 1, share * HEIGHTS)));
    }
    printf("  %.3g to %.3g\n", low, high);
}

static bool info(const char *path, error *e)
{
    motor m;
    recording r;
    if ((motor_path != NULL && !motor_read(motor_path, &m, e)) || !recording_read(path, &r, e)) {
        return false;
    }
    printf("%s: %zu rows, ", path, r.rows);
    if (r.T_s > 0.0) {
        printf("control cycle %.6g us (%.6g Hz)\n", 1e6 * r.T_s, 1.0 / r.T_s);
    } else {
        printf("no two rows are consecutive\n");
    }
    print_columns(&r);
    print_runs(&r, motor_path != NULL ? &m : NULL);
    putchar('\n');
    print_bars(&r, "electric, Hz", speed_of);
    print_bars(&r, "current, A", current_of);
    recording_free(&r);
    return true;
}

int cmd_info(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_info, argc, argv);
    const bool ok =
        options_read(&o, &e) && (o.helped || (options_recording(&o, &e) && info(o.argv[o.first], &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

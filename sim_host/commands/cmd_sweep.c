/*
 * iqfoc sweep: the errors of each method over the ratio of switching to fundamental frequency.
 */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "base/progress.h"
#include "command.h"
#include "induction/induction_table.h"
#include "options.h"
#include "reproduce/sweep.h"
#include "sweep_special.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SPEEDS_MAX = 1000 };

enum { OPT_MOTOR, OPT_RPM, OPT_CURRENT, OPT_ID_RATIO, OPT_JSON, OPT_MAP, OPT_OUTPUT, OPT_INDUCTION };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file"},
    {"rpm", 0, "N[,N...]", "mechanical speeds in rpm; negative: reverse"},
    {"current-rms", 0, "A", "phase current in A rms; default: the motor file's rated current"},
    {"id-ratio", 0, "X", "i_d as a share of the current, -1 to 1; default 0"},
    {"json", 0, "F", "write the points to file F; - is stdout, without the table"},
    {"map", 0, NULL, "instead: which mean current is enough where"},
    {"output", 'o', "DIR", "the folder for a page with the picture; with --map sweep-map if not given"},
    {"induction", 0, NULL, "instead: the errors for a traction induction machine at 500 Hz switching"},
    {NULL, 0, NULL, NULL}};

static const command_about about = {
    "sweep",
    "--motor M.toml --rpm N[,N...] [--current-rms A] [--id-ratio X] [-o DIR] [--json F]\n"
    "       iqfoc sweep --motor M.toml --map [-o DIR] [--json F]\n"
    "       iqfoc sweep --induction [--json F]",
    "Runs the switching-level drive in steady state at each speed, the current regulated at the\n"
    "mid-point sample to the given value, and prints each method's rms error over the rms phase\n"
    "current in percent: mean current over a cycle (standard: the mid-point sample; quasi-discrete:\n"
    "2019 (10)) and current at the next cycle's start (standard: Euler, 2019 (3); quasi-discrete:\n"
    "2019 (12)), each also by the exact solution. In JSON also through the firmware's IQ24\n"
    "functions, under \"iq24\".\n"
    "All but the exact are for machines without saliency; of a salient motor they get\n"
    "L = (L_d + L_q)/2.\n"
    "Where the DC link cannot hold a point, it is raised for that point, and this is said.\n"
    "--map compares four means of the dq current over SFFR 3 to 100, modulation index and load.",
    specs};

typedef struct request {
    const char *motor_path, *json_path;
    double rpm[SPEEDS_MAX];
    size_t speeds;
    double current_A_rms; /* 0: rated */
    double id_ratio;
    const char *directory; /* NULL: no page */
    bool map, induction, helped;
} request;

static bool take_option(const options *o, int which, request *r, error *e)
{
    switch (which) {
    case OPT_MOTOR:
        r->motor_path = o->argument;
        return true;
    case OPT_RPM:
        return options_numbers(o, -1e6, 1e6, r->rpm, SPEEDS_MAX, &r->speeds, e);
    case OPT_CURRENT:
        return options_number(o, 1e-3, 1e6, &r->current_A_rms, e);
    case OPT_ID_RATIO:
        return options_number(o, -1.0, 1.0, &r->id_ratio, e);
    case OPT_JSON:
        r->json_path = o->argument;
        return true;
    case OPT_MAP:
        r->map = true;
        return true;
    case OPT_INDUCTION:
        r->induction = true;
        return true;
    case OPT_OUTPUT:
        r->directory = o->argument;
        return true;
    default:
        return false;
    }
}

static bool parse(int argc, char **argv, request *r, error *e)
{
    options o = options_begin(&about, argc, argv);
    int which;
    while ((which = options_next(&o, e)) >= 0) {
        if (!take_option(&o, which, r, e)) {
            return false;
        }
    }
    r->helped = o.helped;
    if (which == OPTIONS_ERROR || o.helped) {
        return which != OPTIONS_ERROR;
    }
    if (r->induction && (r->motor_path != NULL || r->map || r->speeds > 0)) {
        return error_input(e, NULL, 0, 0,
                           "sweep: --induction brings its own machine; expected no --motor, --rpm or --map");
    }
    if (r->motor_path == NULL && !r->induction) {
        return options_missing(&o, OPT_MOTOR, e);
    }
    if (r->map && r->speeds > 0) {
        return error_input(e, NULL, 0, 0, "sweep: --map takes no --rpm; expected one of the two");
    }
    if (r->speeds == 0 && !r->map && !r->induction) {
        return options_missing(&o, OPT_RPM, e);
    }
    return options_at_most(&o, 0, e);
}

static void print_point(const sweep_point *p)
{
    printf("%10g  %8.4g", p->n_rpm, p->sffr);
    const method_error *errors = p->errors.of;
    printf("  %10.4g  %14.4g  %10.4g", errors[METHOD_MEAN_STANDARD].rms_percent,
           errors[METHOD_MEAN_QUASI_DISCRETE].rms_percent, p->exact.mean.rms_percent);
    printf("  %10.4g  %14.4g  %10.4g", errors[METHOD_PREDICTION_STANDARD].rms_percent,
           errors[METHOD_PREDICTION_QUASI_DISCRETE].rms_percent, p->exact.prediction.rms_percent);
    if (p->link_raised) {
        printf("  DC link raised to %.4g V", p->u_dc_V);
    }
    putchar('\n');
}

static void print_head(const motor *m, double current_A_rms, double id_ratio)
{
    printf("%s: %g A rms, i_d = %g of it; errors in percent of the rms phase current\n", m->name,
           current_A_rms, id_ratio);
    if (m->L_d_H != m->L_q_H) {
        printf("The machine is salient; standard and quasi-discrete get L = (L_d + L_q)/2 = %g H.\n",
               0.5 * (m->L_d_H + m->L_q_H));
    }
    static const char *const columns[2] = {"mean", "prediction"};
    printf("%10s  %8s", "", "");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s", columns[k], columns[k], columns[k]);
    }
    printf("\n%10s  %8s", "rpm", "SFFR");
    for (int k = 0; k < 2; k++) {
        printf("  %10s  %14s  %10s", "standard", "quasi-discrete", "exact");
    }
    putchar('\n');
}

static bool write_json(const request *r, const char *path, const motor *m, double current_A_rms,
                       const sweep_point *points, error *e)
{
    json_t *list = json_array();
    for (size_t n = 0; n < r->speeds; n++) {
        if (json_array_append_new(list, sweep_point_json(&points[n])) != 0) {
            json_decref(list);
            return error_failure(e, 0, "sweep: out of memory");
        }
    }
    json_t *root =
        json_pack("{s:s, s:f, s:f, s:f, s:o}", "motor", m->name, "current_A_rms", current_A_rms, "id_ratio",
                  r->id_ratio, "L_used_H", 0.5 * (m->L_d_H + m->L_q_H), "points", list);
    const bool ok = path != NULL && json_file_write(path, root, e);
    json_decref(root);
    return ok;
}

static void print_table(const request *r, const motor *m, double current_A_rms, const sweep_point *points)
{
    print_head(m, current_A_rms, r->id_ratio);
    for (size_t n = 0; n < r->speeds; n++) {
        print_point(&points[n]);
    }
}

/* All points are computed before the first line is printed, so that an impossible one leaves no half table. */
static bool compute(const request *r, const motor *m, double current_A_rms, sweep_point *points, error *e)
{
    method_machine machine;
    if (!method_machine_of(m, &machine, e)) {
        return false;
    }
    const double complex i_dq_A =
        sqrt(2.0) * current_A_rms * vec_complex(r->id_ratio, sqrt(1.0 - r->id_ratio * r->id_ratio));
    progress shown = progress_begin("sweep", (double)r->speeds, "speeds");
    bool ok = true;
    for (size_t n = 0; n < r->speeds && ok; n++) {
        ok = sweep_point_at(m, &machine, r->rpm[n], i_dq_A, &points[n], e);
        progress_update(&shown, (double)n);
    }
    progress_end(&shown);
    return ok;
}

static bool points_and_files(const request *r, const motor *m, double current_A_rms, sweep_point *points,
                             error *e)
{
    out_folder f = {0};
    const bool ok = out_folder_open(&f, r->directory, e) && compute(r, m, current_A_rms, points, e) &&
                    (f.stage == NULL || sweep_page(f.stage, m, points, r->speeds, e)) &&
                    (r->json_path == NULL ||
                     write_json(r, out_folder_place(&f, r->json_path, e), m, current_A_rms, points, e));
    return out_folder_close(&f, ok, e);
}

static bool sweep(const request *r, error *e)
{
    motor m;
    if (!motor_read(r->motor_path, &m, e)) {
        return false;
    }
    m.ext = motor_blank().ext; /* the study's drive has no effects, so its firmware corrects none */
    sweep_point *points = calloc(SPEEDS_MAX, sizeof *points);
    if (points == NULL) {
        return error_failure(e, 0, "sweep: out of memory");
    }
    const double current_A_rms = r->current_A_rms > 0.0 ? r->current_A_rms : m.I_rated_A_rms;
    const bool ok = points_and_files(r, &m, current_A_rms, points, e);
    if (ok && (r->json_path == NULL || strcmp(r->json_path, "-") != 0)) {
        print_table(r, &m, current_A_rms, points);
    }
    free(points);
    return ok;
}

static bool run(const request *r, error *e)
{
    motor m;
    if (r->induction) {
        return induction_table(r->json_path, e);
    }
    if (!r->map) {
        return sweep(r, e);
    }
    return motor_read(r->motor_path, &m, e) && sweep_map(&m, r->directory, r->json_path, e);
}

int cmd_sweep(int argc, char **argv)
{
    request r = {0};
    error e = {0};
    if (!parse(argc, argv, &r, &e) || (!r.helped && !run(&r, &e))) {
        return error_print(&e);
    }
    return STATUS_DONE;
}

/* iqfoc sweep: the errors of each method over the ratio of switching to fundamental frequency. */
#include "base/confine.h"
#include "base/json_file.h"
#include "base/number.h"
#include "base/out_folder.h"
#include "base/progress.h"
#include "command.h"
#include "data/motor.h"
#include "induction/induction_table.h"
#include "options.h"
#include "reproduce/mean_map.h"
#include "reproduce/sweep.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SPEEDS_MAX = 1000 };

typedef struct request {
    const char *motor_path, *json_path;
    double rpm[SPEEDS_MAX];
    size_t speeds;
    double current_A_rms; /* 0: rated */
    double id_ratio;
    const char *directory; /* NULL: no page */
    bool map, induction;
} request;

static request asked;

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path},
    {"rpm", 0, "N[,N...]", "mechanical speeds in rpm; negative: reverse", .number = asked.rpm,
     .count = &asked.speeds, .most = SPEEDS_MAX, .low = -1e6, .high = 1e6},
    {"current-rms", 0, "A", "phase current in A rms; default: the motor file's rated current",
     .number = &asked.current_A_rms, .low = 1e-3, .high = 1e6},
    {"id-ratio", 0, "X", "i_d divided by the current, -1 to 1; default 0", .number = &asked.id_ratio,
     .low = -1.0, .high = 1.0},
    {"json", 0, "F", "write the points to file F; - is stdout, without the table", .text = &asked.json_path,
     .written = true},
    {"map", 0, NULL, "instead: the cheapest sufficient mean current, as a map", .flag = &asked.map},
    {"output", 'o', "DIR", "the folder for a page with the picture; with --map sweep-map if not given",
     .text = &asked.directory},
    {"induction", 0, NULL, "instead: the errors for a traction induction machine at 500 Hz switching",
     .flag = &asked.induction},
    {.name = NULL}};

const command_about about_sweep = {
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
    "Only the exact solution handles saliency; the others use L = (L_d + L_q)/2.\n"
    "If the DC link is too low for a point, it is raised for that point, and the line says so.\n"
    "--map compares four means of the dq current over SFFR 3 to 100, modulation index and load.",
    specs};

/* Refuses missing options and options that exclude each other. */
static bool combination(const options *o, const request *r, error *e)
{
    if (r->induction && (r->motor_path != NULL || r->map || r->speeds > 0)) {
        return error_input(e, NULL, 0, 0,
                           "sweep: --induction has its own machine; remove --motor, --rpm and --map");
    }
    if (r->motor_path == NULL && !r->induction) {
        return options_missing(o, "motor", e);
    }
    if (r->map && r->speeds > 0) {
        return error_input(e, NULL, 0, 0, "sweep: --map and --rpm exclude each other; give one");
    }
    if (r->speeds == 0 && !r->map && !r->induction) {
        return options_missing(o, "rpm", e);
    }
    return options_at_most(o, 0, e);
}

static void print_point(const sweep_point *p)
{
    char sffr[NUMBER_TEXT_SIZE];
    printf("%10g  %8s", p->n_rpm, number_or_dash(p->sffr, 4, sffr));
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
        printf("The machine is salient; standard and quasi-discrete use L = (L_d + L_q)/2 = %g H.\n",
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

static json_t *points_json(const request *r, const motor *m, double current_A_rms, const sweep_point *points)
{
    json_t *list = json_array();
    for (size_t n = 0; n < r->speeds; n++) {
        if (json_array_append_new(list, sweep_point_json(&points[n])) != 0) {
            json_free(list);
            return NULL; /* out of memory; the writer reports it */
        }
    }
    return json_pack("{s:s, s:f, s:f, s:f, s:o}", "motor", m->name, "current_A_rms", current_A_rms,
                     "id_ratio", r->id_ratio, "L_used_H", 0.5 * (m->L_d_H + m->L_q_H), "points", list);
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

static bool sweep(const request *r, error *e)
{
    static sweep_point points[SPEEDS_MAX];
    motor m;
    if (!motor_read(r->motor_path, &m, e)) {
        return false;
    }
    m.ext = motor_blank().ext; /* the study's drive has no effects, so its firmware corrects none */
    const double current_A_rms = r->current_A_rms > 0.0 ? r->current_A_rms : m.I_rated_A_rms;
    out_folder f = {0};
    bool ok = out_folder_open(&f, r->directory, e) && compute(r, &m, current_A_rms, points, e) &&
              (f.stage == NULL || sweep_page(f.stage, &m, points, r->speeds, e)) &&
              json_file_place(&f, r->json_path, points_json(r, &m, current_A_rms, points), e);
    ok = out_folder_close(&f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        print_head(&m, current_A_rms, r->id_ratio);
        for (size_t n = 0; n < r->speeds; n++) {
            print_point(&points[n]);
        }
    }
    return ok;
}

/* Without -o the page goes to "sweep-map", or is left out if there is JSON. */
static bool sweep_map(const request *r, error *e)
{
    static mean_map map;
    motor m;
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "sweep-map";
    if (!motor_read(r->motor_path, &m, e)) {
        return false;
    }
    out_folder f = {0};
    bool ok = out_folder_open(&f, directory, e) && mean_map_run(&m, &map, e) &&
              (f.stage == NULL || mean_map_page(f.stage, &m, &map, e));
    if (ok) {
        json_t *root = json_pack("{s:s, s:o}", "motor", m.name, "points", mean_map_json(&map));
        ok = json_file_place(&f, r->json_path, root, e);
    }
    ok = out_folder_close(&f, ok, e);
    if (ok && directory != NULL && !json_file_is_stdout(r->json_path)) {
        printf("Map: %s/index.html, %s/mean-map.svg\n", directory, directory);
    }
    return ok;
}

static bool run(const request *r, error *e)
{
    if (!r->map) {
        confine(CONFINE_TO_FILES); /* only the map needs gnuplot */
    }
    return r->induction ? induction_table(r->json_path, e) : r->map ? sweep_map(r, e) : sweep(r, e);
}

int cmd_sweep(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_sweep, argc, argv);
    const bool ok = options_read(&o, &e) && (o.helped || (combination(&o, &asked, &e) && run(&asked, &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

/* iqfoc plan: designs a test recording, from a motor file and limits. */
#include "base/json_file.h"
#include "command.h"
#include "drive/drive_scenario.h"
#include "options.h"
#include "plan/plan_tell.h"

#include <math.h>
#include <stdio.h>

typedef struct request {
    const char *motor_path, *against_path, *json_path, *out_path, *header_path;
    double current, speed, u_dc, seconds, noise, full_scale; /* negative: the default */
    long bits, seed;
} request;

static request asked = {.current = -1.0,
                        .speed = -1.0,
                        .u_dc = -1.0,
                        .seconds = -1.0,
                        .noise = -1.0,
                        .full_scale = -1.0,
                        .bits = 12,
                        .seed = 1};

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path, .needed = true},
    {"current", 0, "A", "largest peak current; default: the rated peak", .number = &asked.current,
     .low = 1e-3, .high = 1e5},
    {"speed", 0, "RPM", "highest speed, both directions; default: n_max_rpm", .number = &asked.speed,
     .low = 1.0, .high = 1e6},
    {"u-dc", 0, "V", "voltage of the DC link; default: the motor file's", .number = &asked.u_dc, .low = 1.0,
     .high = 1e5},
    {"seconds", 0, "S", "duration of all runs, settling included; default: 4, or that of --against",
     .number = &asked.seconds, .low = 0.1, .high = 600.0},
    {"noise", 0, "A", "standard deviation of a current sample; default: 0.3 % of the rated peak",
     .number = &asked.noise, .low = 0.0, .high = 1e4},
    {"bits", 0, "N", "bits of the current's converter; default: 12; 0: not quantised", .integer = &asked.bits,
     .low = 0, .high = 24},
    {"full-scale", 0, "A", "range of the converter, both signs; default: three times the rated peak",
     .number = &asked.full_scale, .low = 1e-3, .high = 1e6},
    {"against", 0, "S.toml", "a scenario to compare with, with the same time and sensors",
     .text = &asked.against_path},
    {"seed", 0, "N", "seed of the sensors' noise; default: 1", .integer = &asked.seed, .low = 0,
     .high = 1000000000},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {"output", 'o', "PLAN.toml", "the scenario, for iqfoc simulate and for a test bench",
     .text = &asked.out_path, .written = true},
    {"firmware", 0, "F.h", "the runs as constants for a firmware (examples/planned_recording)",
     .text = &asked.header_path, .written = true},
    {.name = NULL}};

const command_about about_plan = {
    "plan",
    "--motor M.toml [--current A] [--speed RPM] [--u-dc V] [--seconds S] [--against S.toml] -o "
    "PLAN.toml\n[--firmware F.h]",
    "Designs a test recording for iqfoc diagnose that separates the possible causes. It chooses pulses\n"
    "and steps at standstill, steps at speeds of both directions, run-ups and currents through zero,\n"
    "by the information matrix. Prints the expected intervals, the smallest reported size of each\n"
    "cause, and the cause's closest alternative.",
    specs};

static double or_default(double given, double usual)
{
    return given < 0.0 ? usual : given;
}

static plan_limits limits_of(const request *r, const motor *m)
{
    const double peak = motor_rated_peak_A(m);
    const plan_limits l = {.current_A = or_default(r->current, peak),
                           .speed_rpm = or_default(r->speed, m->n_max_rpm),
                           .u_dc_V = or_default(r->u_dc, m->u_dc_V),
                           .seconds = or_default(r->seconds, 4.0),
                           .noise_A = or_default(r->noise, 0.003 * peak),
                           .bits = (int)r->bits,
                           .full_scale_A = or_default(r->full_scale, ceil(3.0 * peak))};
    return l;
}

/* The scenario's time, unless --seconds is given, and its sensors. */
static bool look_against(const request *r, plan_report *p, error *e)
{
    scenario s;
    if (!scenario_read(r->against_path, &s, e)) {
        return false;
    }
    if (!drive_scenario_plain(&s, r->against_path, e)) {
        scenario_free(&s);
        return false;
    }
    p->against_path = r->against_path;
    p->against_seconds = plan_cycles_of(p->motor, &s) / p->motor->f_pwm_Hz;
    p->limits.seconds = or_default(r->seconds, p->against_seconds);
    p->limits.noise_A = s.sensors.current_noise_A;
    p->limits.bits = s.sensors.current_bits;
    p->limits.full_scale_A = s.sensors.current_full_scale_A;
    const bool ok = plan_look(p->motor, &s, r->seed, &p->against, e);
    scenario_free(&s);
    return ok;
}

/* All outputs together, or none if a part cannot be written. */
static bool write_all(const request *r, const plan_report *p, error *e)
{
    const char *const paths[] = {r->out_path, r->header_path, r->json_path};
    out_folder f;
    bool ok = out_folder_open_for(&f, paths, sizeof paths / sizeof paths[0], e);
    if (ok && r->out_path != NULL) {
        const char *path = out_folder_place(&f, r->out_path, e);
        ok = path != NULL && plan_write_scenario(p, path, e);
    }
    if (ok && r->header_path != NULL) {
        const char *path = out_folder_place(&f, r->header_path, e);
        ok = path != NULL && plan_write_header(p, path, e);
    }
    ok = ok && json_file_place(&f, r->json_path, plan_json(p), e);
    return out_folder_close(&f, ok, e);
}

static bool make(const request *r, error *e)
{
    static motor m;
    static plan_report p;
    if (!motor_read(r->motor_path, &m, e)) {
        return false;
    }
    p.motor = &m;
    p.limits = limits_of(r, &m);
    const bool ok = (r->against_path == NULL || look_against(r, &p, e)) &&
                    plan_make(&m, &p.limits, r->seed, &p.plan, e) && write_all(r, &p, e);
    if (ok && !json_file_is_stdout(r->json_path) && !json_file_is_stdout(r->out_path)) {
        plan_print(&p, stdout);
    }
    return ok;
}

int cmd_plan(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_plan, argc, argv);
    bool ok = options_read(&o, &e);
    if (ok && !o.helped) {
        ok = options_complete(&o, &e) && make(&asked, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}

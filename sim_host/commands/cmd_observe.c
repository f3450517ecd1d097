/* iqfoc observe: the firmware's observer without a sensor over a recording. */
#include "observe/observe.h"

#include "base/json_file.h"
#include "command.h"
#include "options.h"

#include <stdio.h>

enum { OPT_MOTOR, OPT_BANDWIDTH, OPT_DIR, OPT_JSON };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file"},
    {"bandwidth", 0, "W", "of the phase-locked loop, rad/s, up to 1/T; default: 0.16/T"},
    {"output", 'o', "DIR", "write index.html into DIR: speed and angle error over time, tables"},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text"},
    {NULL, 0, NULL, NULL}};

const command_about about_observe = {
    "observe", "REC.csv --motor M.toml [--bandwidth W] [-o DIR] [--json F]",
    "Runs the firmware's observer of iqfoc/observer.h over the currents and voltages of a recording, and\n"
    "compares its angle with the recorded one: over speed and over current. Corrections of the motor\n"
    "file ([extension...]) are in force, those of the recorded angle included. Each run begins half a\n"
    "turn off.",
    specs};

typedef struct request {
    const char *recording_path, *motor_path, *directory, *json_path;
    double bandwidth_rad_s;
} request;

static bool take_recording(const options *o, request *r, error *e)
{
    if (r->motor_path == NULL) {
        return options_missing(o, OPT_MOTOR, e);
    }
    if (o->argc == o->first) {
        return error_input(e, NULL, 0, 0, "observe: no recording is given. Usage: iqfoc observe %s",
                           about_observe.usage);
    }
    r->recording_path = o->argv[o->first];
    return options_at_most(o, 1, e);
}

static bool observe(const request *r, error *e)
{
    motor m;
    recording rec;
    observe_result result;
    if (!motor_read(r->motor_path, &m, e) || !recording_read(r->recording_path, &rec, e)) {
        return false;
    }
    out_folder f = {0};
    chart_data series = chart_data_of(OBSERVE_COLUMNS);
    bool ok =
        out_folder_open(&f, r->directory, e) &&
        observe_recording(&rec, &m, r->bandwidth_rad_s, &result, r->directory != NULL ? &series : NULL, e) &&
        (r->directory == NULL || observe_page(f.stage, &m, &result, &series, e)) &&
        json_file_place(&f, r->json_path, observe_json(&m, &result), e);
    ok = out_folder_close(&f, ok, e);
    chart_data_free(&series);
    recording_free(&rec);
    if (ok && !json_file_is_stdout(r->json_path)) {
        observe_print(&m, &result, stdout);
        if (r->directory != NULL) {
            printf("\n  page: %s/index.html\n", r->directory);
        }
    }
    return ok;
}

int cmd_observe(int argc, char **argv)
{
    request r = {0};
    error e = {0};
    const option_place places[] = {[OPT_MOTOR] = {.text = &r.motor_path},
                                   [OPT_BANDWIDTH] = {.number = &r.bandwidth_rad_s, .low = 1e-3, .high = 1e6},
                                   [OPT_DIR] = {.text = &r.directory},
                                   [OPT_JSON] = {.text = &r.json_path, .written = true}};
    options o = options_begin(&about_observe, argc, argv);
    const bool ok =
        options_read(&o, places, &e) && (o.helped || (take_recording(&o, &r, &e) && observe(&r, &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

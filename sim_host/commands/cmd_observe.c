/* iqfoc observe: the firmware's observer without a sensor over a recording. */
#include "observe/observe.h"

#include "base/json_file.h"
#include "command.h"
#include "options.h"

#include <stdio.h>

typedef struct request {
    const char *recording_path, *motor_path, *directory, *json_path;
    double bandwidth_rad_s;
} request;

static request asked;

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path},
    {"bandwidth", 0, "W", "of the phase-locked loop, rad/s, up to 1/T; default: 0.16/T",
     .number = &asked.bandwidth_rad_s, .low = 1e-3, .high = 1e6},
    {"output", 'o', "DIR", "write index.html into DIR: speed and angle error over time, tables",
     .text = &asked.directory},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {.name = NULL}};

const command_about about_observe = {
    "observe", "REC.csv --motor M.toml [--bandwidth W] [-o DIR] [--json F]",
    "Runs the firmware's observer of iqfoc/observer.h over the currents and voltages of a recording, and\n"
    "compares its angle with the recorded one: over speed and over current. Corrections of the motor\n"
    "file ([extension...]) are in force, those of the recorded angle included. Each run begins half a\n"
    "turn off.",
    specs};

static bool take_recording(const options *o, request *r, error *e)
{
    if (r->motor_path == NULL) {
        return options_missing(o, "motor", e);
    }
    r->recording_path = o->argv[o->first];
    return options_recording(o, e);
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
    error e = {0};
    options o = options_begin(&about_observe, argc, argv);
    const bool ok =
        options_read(&o, &e) && (o.helped || (take_recording(&o, &asked, &e) && observe(&asked, &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

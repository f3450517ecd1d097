/* iqfoc loops: closed loops with different feedback, predictors and controllers. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "loops/extended_loops.h"
#include "loops/loops_study.h"
#include "loops/pulse_run_ups.h"
#include "options.h"
#include "plant/plant_effect.h"

#include <stdio.h>

typedef struct request {
    const char *motor_path, *extended_path, *json_path, *directory;
    option_texts effects;
    bool pulse_modes;
} request;

static request asked;

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "with --extended: the motor file", .text = &asked.motor_path},
    {"extended", 0, "X.toml", "instead: compare control by M.toml with control by this extended file",
     .text = &asked.extended_path},
    {"effect", 0, "id[:key=value,...]",
     "with --extended: effect that the drive has and M.toml has not; repeatable", .texts = &asked.effects},
    {"pulse-modes", 0, NULL, "instead: run two drives through all pulse modes", .flag = &asked.pulse_modes},
    {"json", 0, "F", "write the results to file F; - is stdout, without the tables", .text = &asked.json_path,
     .written = true},
    {"output", 'o', "DIR",
     "folder of the report page; default: report-loops,\nor no page if --json is given without -o",
     .text = &asked.directory},
    {.name = NULL}};

const command_about about_loops = {
    "loops",
    "[--pulse-modes] [--json F] [-o DIR]\n"
    "       iqfoc loops --motor M.toml --extended X.toml [--effect id[:key=value,...]]... [--json F]",
    "Runs the firmware's controllers on the simulated drive of the 2019 paper:\n"
    "- six-step torque control with discrete-angle and with corrected feedback;\n"
    "- PI control with angle advance, and deadbeat control with the Euler, quasi-discrete and exact\n"
    "  predictor, over the switching-to-fundamental frequency ratio and over parameter errors;\n"
    "- finite-set control with horizons of 1 to 3;\n"
    "- PI control on the observed angle, without an angle sensor.\n"
    "--pulse-modes runs that drive and one of 400 kW from standstill through synchronous carrier, pulse\n"
    "patterns and six-step and back. DIR/index.html has the plots. --extended compares control by the motor "
    "file with control by the\n"
    "extended file of a diagnosis, on a drive that differs from the motor file.",
    specs};

/* --extended and --motor need each other, and --effect needs both; no page is drawn then, and --pulse-modes is another run. */
static bool combination(const options *o, const request *r, error *e)
{
    if (r->extended_path == NULL && r->motor_path == NULL && r->effects.count == 0) {
        return true;
    }
    if (r->motor_path == NULL) {
        return options_missing(o, "motor", e);
    }
    if (r->extended_path == NULL) {
        return options_missing(o, "extended", e);
    }
    if (r->pulse_modes) {
        return error_input(e, NULL, 0, 0, "loops: --pulse-modes has its own drives; remove --extended");
    }
    return r->directory == NULL || error_input(e, NULL, 0, 0, "loops: --extended draws no page; remove -o");
}

static bool compare_extended(const request *r, error *e)
{
    motor nominal;
    motor extended;
    if (!motor_read(r->motor_path, &nominal, e) || !motor_read(r->extended_path, &extended, e)) {
        return false;
    }
    plant_config drive = plant_config_from_motor(&nominal);
    for (int n = 0; n < r->effects.count; n++) {
        if (!plant_effect_apply(&drive, r->effects.of[n], e)) {
            return false;
        }
    }
    const motor *const belief[EXTENDED_BELIEFS] = {&nominal, &extended};
    extended_loops all;
    if (!extended_loops_run(belief, &drive, &all, e)) {
        return false;
    }
    out_folder none = {0};
    const bool ok = json_file_place(&none, r->json_path, extended_loops_json(&all), e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        extended_loops_print(&all, stdout);
    }
    return ok;
}

static loops_study study;
static pulse_run_ups pulse_modes;

static bool run(const request *r, out_folder *f, error *e)
{
    if (r->pulse_modes) {
        return pulse_run_ups_run(&pulse_modes, e) &&
               (f->stage == NULL || pulse_run_ups_page(&pulse_modes, f->stage, e)) &&
               json_file_place(f, r->json_path, pulse_run_ups_json(&pulse_modes), e);
    }
    return loops_study_run(&study, e) && (f->stage == NULL || loops_study_page(&study, f->stage, e)) &&
           json_file_place(f, r->json_path, loops_study_json(&study), e);
}

static bool loops(const request *r, error *e)
{
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "report-loops";
    out_folder f = {0};
    bool ok = out_folder_open(&f, directory, e) && run(r, &f, e);
    ok = out_folder_close(&f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        if (r->pulse_modes) {
            pulse_run_ups_print(&pulse_modes, stdout);
        } else {
            loops_study_print(&study, stdout);
        }
        if (directory != NULL) {
            printf("\nPlots: %s/index.html\n", directory);
        }
    }
    return ok;
}

int cmd_loops(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_loops, argc, argv);
    bool ok = options_read(&o, &e);
    if (ok && !o.helped) {
        ok = combination(&o, &asked, &e) && options_complete(&o, &e) &&
             (asked.extended_path != NULL ? compare_extended(&asked, &e) : loops(&asked, &e));
    }
    return ok ? STATUS_DONE : error_print(&e);
}

/*
 * iqfoc loops: what better feedback and better prediction do to a closed loop.
 */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "loops/extended_loops.h"
#include "loops/loops_study.h"
#include "options.h"
#include "plant/plant_effect.h"

#include <stdlib.h>
#include <string.h>

enum { EFFECTS_MAX = 32 };

enum { OPT_MOTOR, OPT_EXTENDED, OPT_EFFECT, OPT_JSON, OPT_OUTPUT };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "with --extended: the motor file"},
    {"extended", 0, "X.toml", "instead: control by M.toml and by this file, as a diagnosis writes it"},
    {"effect", 0, "id[:key=value,...]", "with --extended: how the drive differs from M.toml; repeatable"},
    {"json", 0, "F", "write the results to file F; - is stdout, without the tables"},
    {"output", 'o', "DIR",
     "where the report page goes; default: report-loops,\nor no page if --json is given without -o"},
    {NULL, 0, NULL, NULL}};

static const command_about about = {
    "loops",
    "[--json F] [-o DIR]\n"
    "       iqfoc loops --motor M.toml --extended X.toml [--effect id[:key=value,...]]... [--json F]",
    "Runs the firmware's controllers against the switching-level drive of the 2019 paper:\n"
    "six-step torque control with discrete-angle and with corrected feedback; PI control with angle\n"
    "advance and deadbeat control with the Euler, the quasi-discrete and the exact predictor, over\n"
    "the ratio of switching to fundamental frequency and over errors of the parameters; control by\n"
    "a finite set of states over horizons of 1 to 3. DIR/index.html has the plots.\n"
    "--extended compares control by the motor file with control by the extended file that a\n"
    "diagnosis wrote, of a drive that differs from the first.",
    specs};

typedef struct request {
    const char *motor_path, *extended_path, *effect[EFFECTS_MAX];
    int effects;
    const char *json_path, *directory;
    bool helped;
} request;

static bool take_option(const options *o, int which, request *r, error *e)
{
    switch (which) {
    case OPT_MOTOR:
        r->motor_path = o->argument;
        return true;
    case OPT_EXTENDED:
        r->extended_path = o->argument;
        return true;
    case OPT_EFFECT:
        if (r->effects == EFFECTS_MAX) {
            return error_input(e, NULL, 0, 0, "loops: more than %d effects", EFFECTS_MAX);
        }
        r->effect[r->effects++] = o->argument;
        return true;
    case OPT_JSON:
        r->json_path = o->argument;
        return true;
    default:
        r->directory = o->argument;
        return true;
    }
}

/* --extended and --motor need each other, and --effect needs both; no page is drawn then. */
static bool combination(const options *o, const request *r, error *e)
{
    if (r->extended_path == NULL && r->motor_path == NULL && r->effects == 0) {
        return true;
    }
    if (r->motor_path == NULL) {
        return options_missing(o, OPT_MOTOR, e);
    }
    if (r->extended_path == NULL) {
        return options_missing(o, OPT_EXTENDED, e);
    }
    return r->directory == NULL ||
           error_input(e, NULL, 0, 0, "loops: --extended draws no page: expected no -o");
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
    return which != OPTIONS_ERROR && (o.helped || (combination(&o, r, e) && options_at_most(&o, 0, e)));
}

static bool write_json(const char *path, const loops_study *s, error *e)
{
    json_t *root = loops_study_json(s);
    const bool ok = path != NULL && json_file_write(path, root, e);
    json_decref(root);
    return ok;
}

/* directory: NULL for no page. */
static bool study(const request *r, const char *directory, loops_study *s, error *e)
{
    out_folder f = {0};
    const bool ok = out_folder_open(&f, directory, e) && loops_study_run(s, e) &&
                    (f.stage == NULL || loops_study_page(s, f.stage, e)) &&
                    (r->json_path == NULL || write_json(out_folder_place(&f, r->json_path, e), s, e));
    return out_folder_close(&f, ok, e);
}

static bool compare_extended(const request *r, error *e)
{
    motor nominal;
    motor extended;
    if (!motor_read(r->motor_path, &nominal, e) || !motor_read(r->extended_path, &extended, e)) {
        return false;
    }
    plant_config drive = plant_config_from_motor(&nominal);
    for (int n = 0; n < r->effects; n++) {
        if (!plant_effect_apply(&drive, r->effect[n], e)) {
            return false;
        }
    }
    const motor *const belief[EXTENDED_BELIEFS] = {&nominal, &extended};
    extended_loops all;
    if (!extended_loops_run(belief, &drive, &all, e)) {
        return false;
    }
    if (r->json_path != NULL) {
        json_t *root = extended_loops_json(&all);
        const bool ok = json_file_write(r->json_path, root, e);
        json_decref(root);
        if (!ok) {
            return false;
        }
    }
    if (r->json_path == NULL || strcmp(r->json_path, "-") != 0) {
        extended_loops_print(&all, stdout);
    }
    return true;
}

static bool loops(const request *r, error *e)
{
    loops_study *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return error_failure(e, 0, "loops: out of memory");
    }
    const bool quiet = r->json_path != NULL && strcmp(r->json_path, "-") == 0;
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "report-loops";
    const bool ok = study(r, directory, s, e);
    if (ok && !quiet) {
        loops_study_print(s, stdout);
        if (directory != NULL) {
            printf("\nThe figures: %s/index.html\n", directory);
        }
    }
    free(s);
    return ok;
}

int cmd_loops(int argc, char **argv)
{
    request r = {0};
    error e = {0};
    if (!parse(argc, argv, &r, &e) ||
        (!r.helped && !(r.extended_path != NULL ? compare_extended(&r, &e) : loops(&r, &e)))) {
        return error_print(&e);
    }
    return STATUS_DONE;
}

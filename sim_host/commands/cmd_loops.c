/*
 * iqfoc loops: what better feedback and better prediction do to a closed loop.
 */
#include "base/json_file.h"
#include "command.h"
#include "loops/loops_study.h"
#include "options.h"

#include <stdlib.h>
#include <string.h>

enum { OPT_JSON, OPT_OUTPUT };

static const option_spec specs[] = {
    {"json", 0, "F", "write the results to file F; - is stdout, without the tables"},
    {"output", 'o', "DIR",
     "where the report page goes; default: report-loops,\nor no page if --json is given without -o"},
    {NULL, 0, NULL, NULL}};

static const command_about about = {
    "loops", "[--json F] [-o DIR]",
    "Runs the firmware's controllers against the switching-level drive of the 2019 paper:\n"
    "six-step torque control with discrete-angle and with corrected feedback; PI control with angle\n"
    "advance and deadbeat control with the Euler, the quasi-discrete and the exact predictor, over\n"
    "the ratio of switching to fundamental frequency and over errors of the parameters; control by\n"
    "a finite set of states over horizons of 1 to 3. DIR/index.html has the plots.",
    specs};

typedef struct request {
    const char *json_path, *directory;
    bool helped;
} request;

static bool parse(int argc, char **argv, request *r, error *e)
{
    options o = options_begin(&about, argc, argv);
    int which;
    while ((which = options_next(&o, e)) >= 0) {
        if (which == OPT_JSON) {
            r->json_path = o.argument;
        } else {
            r->directory = o.argument;
        }
    }
    r->helped = o.helped;
    return which != OPTIONS_ERROR && (o.helped || options_at_most(&o, 0, e));
}

static bool write_json(const char *path, const loops_study *s, error *e)
{
    json_t *root = loops_study_json(s);
    const bool ok = json_file_write(path, root, e);
    json_decref(root);
    return ok;
}

static bool loops(const request *r, error *e)
{
    loops_study *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return error_failure(e, 0, "loops: out of memory");
    }
    const bool quiet = r->json_path != NULL && strcmp(r->json_path, "-") == 0;
    const char *directory = r->directory != NULL || r->json_path != NULL ? r->directory : "report-loops";
    bool ok = loops_study_run(s, e) && (r->json_path == NULL || write_json(r->json_path, s, e));
    if (ok && !quiet) {
        loops_study_print(s, stdout);
    }
    ok = ok && (directory == NULL || loops_study_page(s, directory, e));
    if (ok && !quiet && directory != NULL) {
        printf("\nThe figures: %s/index.html\n", directory);
    }
    free(s);
    return ok;
}

int cmd_loops(int argc, char **argv)
{
    request r = {0};
    error e = {0};
    if (!parse(argc, argv, &r, &e) || (!r.helped && !loops(&r, &e))) {
        return error_print(&e);
    }
    return STATUS_DONE;
}

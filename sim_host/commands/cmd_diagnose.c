/*
 * iqfoc diagnose: what a recording shows the model to get wrong, why, and what mending it gains.
 */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "diagnose/diagnose.h"
#include "diagnose/show/report.h"
#include "diagnose/tell/json.h"
#include "diagnose/tell/text.h"
#include "options.h"

#include <stdio.h>
#include <string.h>

enum { OPT_MOTOR, OPT_DIR, OPT_JSON, OPT_SKIP, OPT_TRACE };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file, as you have it"},
    {"output", 'o', "DIR",
     "write report.html, motor_extended.toml, iqfoc_extension.h and diagnosis.json into DIR"},
    {"json", 0, "F", "write the diagnosis to file F; - is stdout, without the text"},
    {"skip", 0, "ID[,ID...]", "leave these causes out of the search"},
    {"trace", 0, NULL, "tell on stderr how the search went"},
    {NULL, 0, NULL, NULL}};

static const command_about about = {
    "diagnose", "REC.csv --motor M.toml [-o DIR] [--json F] [--skip ID[,ID...]]",
    "Compares a recording with the averaged model, cycle by cycle; names the effects that account for\n"
    "the difference, with 95 % intervals; and measures on rows that were not fitted what the extended\n"
    "model gains. The exit status is 0 whatever the verdict, 2 if the recording cannot be used.",
    specs};

typedef struct request {
    const char *recording_path, *motor_path, *directory, *json_path;
    diagnose_options options;
    bool helped;
} request;

static bool take_skip(const char *list, hypothesis_set *skip, error *e)
{
    while (*list) {
        char id[64];
        size_t n = strcspn(list, ",");
        snprintf(id, sizeof id, "%.*s", (int)n, list);
        hypothesis_set set = hypotheses_of_cause(id);
        if (set == 0) {
            return error_input(e, NULL, 0, 0, "diagnose: --skip: '%s' is no cause id", id);
        }
        *skip |= set;
        list += n + (list[n] == ',');
    }
    return true;
}

static bool take_option(const options *o, int which, request *r, error *e)
{
    switch (which) {
    case OPT_MOTOR:
        r->motor_path = o->argument;
        return true;
    case OPT_DIR:
        r->directory = o->argument;
        return true;
    case OPT_JSON:
        r->json_path = o->argument;
        return true;
    case OPT_SKIP:
        return take_skip(o->argument, &r->options.skip, e);
    case OPT_TRACE:
        r->options.trace = stderr;
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
    if (r->motor_path == NULL) {
        return options_missing(&o, OPT_MOTOR, e);
    }
    if (o.first >= argc) {
        return error_input(e, NULL, 0, 0, "diagnose: which recording? Usage: iqfoc diagnose %s", about.usage);
    }
    r->recording_path = argv[o.first];
    return o.first + 1 == argc ||
           error_input(e, NULL, 0, 0,
                       "diagnose: one recording at a time; \"%s\" is a second one. Usage: iqfoc diagnose %s",
                       argv[o.first + 1], about.usage);
}

/* Everything that is to be in DIR goes into its stage first. */
static bool write_files(const request *r, out_folder *f, const report_input *in, json_t *json, error *e)
{
    if (f->stage != NULL && !report_write(in, f->stage, json, e)) {
        return false;
    }
    if (r->json_path == NULL) {
        return true;
    }
    const char *path = out_folder_place(f, r->json_path, e);
    return path != NULL && json_file_write(path, json, e);
}

static void print(const request *r, const diagnosis *d)
{
    if (r->json_path != NULL && strcmp(r->json_path, "-") == 0) {
        return;
    }
    text_print(stdout, d);
    if (r->directory != NULL) {
        printf("\n  report: %s/report.html\n", r->directory);
    }
}

/* Files first, words last: what is printed has been written. */
static bool deliver(const request *r, out_folder *f, const report_input *in, error *e)
{
    json_t *json = json_of_diagnosis(in->d);
    if (r->directory != NULL || r->json_path != NULL) {
        report_firmware(in, json);
    }
    bool ok = write_files(r, f, in, json, e);
    json_decref(json);
    ok = out_folder_close(f, ok, e);
    if (ok) {
        print(r, in->d);
    }
    return ok;
}

static bool run(const request *r, error *e)
{
    motor m;
    recording rec;
    diagnosis d;
    out_folder f = {0};
    if (!motor_read(r->motor_path, &m, e) || !recording_read(r->recording_path, &rec, e)) {
        return false;
    }
    diagnose_options how = r->options;
    /* The files need the diagnosis' series, row by row. */
    how.series = r->directory != NULL || r->json_path != NULL;
    bool ok = out_folder_open(&f, r->directory, e) && diagnose(&d, &rec, &m, &how, e);
    if (ok) {
        const report_input in = {&rec, &m, &d};
        ok = deliver(r, &f, &in, e);
        diagnosis_free(&d);
    } else {
        out_folder_close(&f, false, e);
    }
    recording_free(&rec);
    return ok;
}

int cmd_diagnose(int argc, char **argv)
{
    error e = {0};
    request r = {0};
    if (!parse(argc, argv, &r, &e)) {
        return error_print(&e);
    }
    if (r.helped) {
        return STATUS_DONE;
    }
    return run(&r, &e) ? STATUS_DONE : error_print(&e);
}

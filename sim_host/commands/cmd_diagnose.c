/*
 * iqfoc diagnose: what a recording shows the model to get wrong, why, and what mending it gains.
 */
#include "base/json_file.h"
#include "command.h"
#include "diagnose/diagnose.h"
#include "diagnose/show/report.h"
#include "diagnose/tell/json.h"
#include "diagnose/tell/text.h"
#include "diagnose_many.h"
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
    "diagnose", "REC.csv... --motor M.toml [-o DIR] [--json F] [--skip ID[,ID...]]",
    "Compares a recording with the averaged model, cycle by cycle; names the effects that account for\n"
    "the difference, with 95 % intervals; and measures on rows that were not fitted what the extended\n"
    "model gains. The exit status is 0 whatever the verdict, 2 if the recording cannot be used.\n"
    "Several recordings of one motor are diagnosed in parallel, each into DIR/<name>/, with "
    "DIR/summary.json.",
    specs};

typedef struct request {
    const char *recording_path, *motor_path, *directory, *json_path;
    char **recordings; /* all of them */
    int count;
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
    r->recordings = argv + o.first;
    r->count = argc - o.first;
    if (r->count > 1 && (r->directory == NULL || r->json_path != NULL)) {
        return error_input(
            e, NULL, 0, 0,
            "diagnose: several recordings need -o DIR, and no --json: each gets DIR/<name>/diagnosis.json");
    }
    r->recording_path = argv[o.first];
    return true;
}

/* Files first, words last: what is printed has been written. */
static bool deliver(const request *r, const report_input *in, json_t *json, error *e)
{
    if (r->directory && !report_write(in, r->directory, json, e)) {
        return false;
    }
    if (r->json_path && !json_file_write(r->json_path, json, e)) {
        return false;
    }
    if (r->json_path && strcmp(r->json_path, "-") == 0) {
        return true;
    }
    text_print(stdout, in->d);
    if (r->directory) {
        printf("\n  report: %s/report.html\n", r->directory);
    }
    return true;
}

static bool run(const request *r, error *e)
{
    motor m;
    recording rec;
    diagnosis d;
    if (!motor_read(r->motor_path, &m, e) || !recording_read(r->recording_path, &rec, e)) {
        return false;
    }
    diagnose_options how = r->options;
    /* What is measured after the diagnosis goes by its rows. */
    how.series = r->directory != NULL || r->json_path != NULL;
    bool ok = diagnose(&d, &rec, &m, &how, e);
    if (ok) {
        json_t *json = json_of_diagnosis(&d);
        const report_input in = {&rec, &m, &d};
        if (how.series) {
            report_firmware(&in, json);
        }
        ok = deliver(r, &in, json, e);
        json_decref(json);
        diagnosis_free(&d);
    }
    recording_free(&rec);
    return ok;
}

/* One of several, in its own process. */
static bool run_into(const void *request_of_all, const char *recording_path, const char *directory, error *e)
{
    request r = *(const request *)request_of_all;
    r.recording_path = recording_path;
    r.directory = directory;
    return run(&r, e);
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
    if (r.count > 1) {
        int status = STATUS_DONE;
        return diagnose_many(run_into, &r, r.recordings, r.count, r.directory, &status, &e) ? status
                                                                                            : error_print(&e);
    }
    return run(&r, &e) ? STATUS_DONE : error_print(&e);
}

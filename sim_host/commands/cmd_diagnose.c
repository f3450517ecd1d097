/* iqfoc diagnose: what a recording shows the model to get wrong, why, and what mending it gains. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "base/progress.h"
#include "base/suggest.h"
#include "command.h"
#include "data/cause.h"
#include "diagnose/diagnose.h"
#include "diagnose/show/report.h"
#include "diagnose/tell/json.h"
#include "diagnose/tell/text.h"
#include "options.h"

#include <stdio.h>
#include <string.h>

enum { OPT_MOTOR, OPT_DIR, OPT_JSON, OPT_SKIP, OPT_ANY_SIZE, OPT_TRACE };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file, as you have it"},
    {"output", 'o', "DIR",
     "write report.html, motor_extended.toml, iqfoc_extension.h and diagnosis.json into DIR"},
    {"json", 0, "F", "write the diagnosis to file F; - is stdout, without the text"},
    {"skip", 0, "ID[,ID...]", "leave these causes out of the search"},
    {"any-size", 0, NULL, "name what is certain, too small to matter or not"},
    {"trace", 0, NULL, "tell on stderr how the search went"},
    {NULL, 0, NULL, NULL}};

const command_about about_diagnose = {
    "diagnose", "REC.csv --motor M.toml [-o DIR] [--json F] [--skip ID[,ID...]]",
    "Compares a recording with the averaged model, cycle by cycle; names the effects that account for\n"
    "the difference, with 95 % intervals; and measures on rows that were not fitted what the extended\n"
    "model gains. The exit status is 0 whatever the verdict, 2 if the recording cannot be used.",
    specs};

typedef struct request {
    const char *recording_path, *motor_path, *directory, *json_path;
    diagnose_options options;
    bool traced;
    int argc;
    char **argv;
} request;

static bool refuse_cause(const char *given, error *e)
{
    const char *ids[CAUSE_COUNT];
    size_t count = 0;
    for (int k = 0; k < CAUSE_COUNT; k++) {
        if (cause_table[k].named) {
            ids[count++] = cause_table[k].id;
        }
    }
    const char *meant = suggest(given, ids, count);
    return meant != NULL
               ? error_input(e, NULL, 0, 0, "diagnose: --skip: '%s' is no cause id; did you mean %s?", given,
                             meant)
               : error_input(
                     e, NULL, 0, 0,
                     "diagnose: --skip: '%s' is no cause id; `iqfoc simulate --list-effects` has them",
                     given);
}

static bool take_skip(const options *o, void *context, error *e)
{
    hypothesis_set *skip = context;
    for (const char *list = o->argument; *list != '\0';) {
        char id[64];
        size_t n = strcspn(list, ",");
        snprintf(id, sizeof id, "%.*s", (int)n, list);
        hypothesis_set set = hypotheses_of_cause(id);
        if (set == 0) {
            return refuse_cause(id, e);
        }
        *skip |= set;
        list += n + (list[n] == ',');
    }
    return true;
}

/* One recording, and the motor that it is of. */
static bool combination(const options *o, request *r, error *e)
{
    if (r->motor_path == NULL) {
        return options_missing(o, OPT_MOTOR, e);
    }
    const int given = o->argc - o->first;
    char **recordings = &o->argv[o->first];
    if (given == 0) {
        return error_input(e, NULL, 0, 0, "diagnose: which recording? Usage: iqfoc diagnose %s",
                           about_diagnose.usage);
    }
    r->recording_path = recordings[0];
    return given == 1 ||
           error_input(e, NULL, 0, 0,
                       "diagnose: one recording at a time; \"%s\" is a second one. Usage: iqfoc diagnose %s",
                       recordings[1], about_diagnose.usage);
}

/* Files first, words last: what is printed has been written. */
static bool deliver(const request *r, out_folder *f, const report_input *in, error *e)
{
    json_t *json = json_of_diagnosis(in->d);
    if (r->directory != NULL || r->json_path != NULL) {
        report_firmware(in, json);
    }
    /* Everything that is to be in DIR goes into its stage first. */
    bool ok = f->stage == NULL || report_write(in, f->stage, json, e);
    ok = json_file_place(f, ok ? r->json_path : NULL, json, e) && ok;
    ok = out_folder_close(f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        text_print(stdout, in->d);
        if (r->directory != NULL) {
            printf("\n  report: %s/report.html\n", r->directory);
        }
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
    if (rec.omega_derived) {
        fprintf(stderr, "iqfoc: note: %s has no omega_e_rad_s; the speed is the slope of theta_e_rad\n",
                r->recording_path);
    }
    diagnose_options how = r->options;
    progress shown = progress_begin("diagnose", 0.0, "");
    how.teller = (diagnose_teller){.trace = r->traced ? stderr : NULL, .shown = r->traced ? NULL : &shown};
    /* The files need the diagnosis' series, row by row. */
    how.series = r->directory != NULL || r->json_path != NULL;
    bool ok = out_folder_open(&f, r->directory, e) && diagnose(&d, &rec, &m, &how, e);
    progress_end(&shown);
    if (ok) {
        const provenance from = {.argc = r->argc,
                                 .argv = r->argv,
                                 .file = {{"recording", r->recording_path}, {"motor file", r->motor_path}}};
        const report_input in = {&rec, &m, &d, &from};
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
    request r = {.argc = argc, .argv = argv};
    const option_place places[] = {[OPT_MOTOR] = {.text = &r.motor_path},
                                   [OPT_DIR] = {.text = &r.directory},
                                   [OPT_JSON] = {.text = &r.json_path},
                                   [OPT_SKIP] = {.take = take_skip, .context = &r.options.skip},
                                   [OPT_ANY_SIZE] = {.flag = &r.options.any_size},
                                   [OPT_TRACE] = {.flag = &r.traced}};
    options o = options_begin(&about_diagnose, argc, argv);
    const bool ok = options_read(&o, places, &e) && (o.helped || (combination(&o, &r, &e) && run(&r, &e)));
    return ok ? STATUS_DONE : error_print(&e);
}

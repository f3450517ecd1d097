/* iqfoc diagnose: the causes of the model error in a recording, the extended model, and its error reduction. */
#include "base/inputs.h"
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

typedef struct request {
    char **recordings;
    int count;
    const char *motor_path, *directory, *json_path;
    diagnose_options options;
    bool traced, exit_verdict;
    int argc;
    char **argv;
} request;

static request asked;

static bool refuse_cause(const char *given, error *e)
{
    const char *ids[CAUSE_COUNT];
    size_t count = 0;
    for (int k = 0; k < CAUSE_COUNT; k++) {
        if (cause_table[k].named && (int)cause_table[k].of == k) {
            ids[count++] = cause_table[k].id;
        }
    }
    const char *meant = suggest(given, ids, count);
    return meant != NULL
               ? error_input(e, NULL, 0, 0, "diagnose: --skip: unknown cause '%s'; did you mean %s?", given,
                             meant)
               : error_input(
                     e, NULL, 0, 0,
                     "diagnose: --skip: unknown cause '%s'; `iqfoc simulate --list-effects` lists them",
                     given);
}

static bool take_skip(const options *o, error *e)
{
    for (const char *list = o->argument; *list != '\0';) {
        char id[64];
        size_t n = strcspn(list, ",");
        snprintf(id, sizeof id, "%.*s", (int)n, list);
        hypothesis_set set = hypotheses_of_cause(id);
        if (set == 0) {
            return refuse_cause(id, e);
        }
        asked.options.skip |= set;
        list += n + (list[n] == ',');
    }
    return true;
}

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path},
    {"output", 'o', "DIR",
     "write report.html, motor_extended.toml, iqfoc_extension.h and diagnosis.json into DIR",
     .text = &asked.directory},
    {"json", 0, "F", "write the diagnosis to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {"skip", 0, "ID[,ID...]", "search without these causes", .take = take_skip},
    {"any-size", 0, NULL, "name every certain cause, even below its reporting threshold",
     .flag = &asked.options.any_size},
    {"trace", 0, NULL, "print the steps of the search on stderr", .flag = &asked.traced},
    {"exit-verdict", 0, NULL, "exit status by verdict: 0 clean, 10 explained, 11 partly, 12 unexplained",
     .flag = &asked.exit_verdict},
    {.name = NULL}};

const command_about about_diagnose = {
    "diagnose", "REC.csv... --motor M.toml [-o DIR] [--json F] [--skip ID[,ID...]] [--exit-verdict]",
    "Compares a recording with the averaged model, cycle by cycle. Names the causes of the difference,\n"
    "with 95 % intervals. Measures the error of the nominal and the extended model on held-out rows.\n"
    "Of several recordings it prints one line each: verdict, error before and after, causes.\n"
    "Exit status: 0 after a diagnosis, or by verdict with --exit-verdict; 2 if the recording is unusable.",
    specs};

/* The recordings and their motor file. */
static bool combination(const options *o, request *r, error *e)
{
    if (r->motor_path == NULL) {
        return options_missing(o, "motor", e);
    }
    r->recordings = &o->argv[o->first];
    r->count = o->argc - o->first;
    if (r->count == 0) {
        return error_input(e, NULL, 0, 0, "diagnose: no recording is given. Usage: iqfoc diagnose %s",
                           about_diagnose.usage);
    }
    return r->count == 1 || (r->directory == NULL && r->json_path == NULL) ||
           error_input(e, NULL, 0, 0, "diagnose: -o and --json take one recording; \"%s\" is a second one",
                       r->recordings[1]);
}

/* Of the files that -o writes, the one that is a motor file may be an input too. */
static bool reserve_extended(const request *r, error *e)
{
    char path[OUT_FOLDER_LONGEST + 32];
    if (r->directory == NULL) {
        return true;
    }
    snprintf(path, sizeof path, "%s/motor_extended.toml", r->directory);
    return inputs_reserve(path, e);
}

/* Of one recording among several. */
static void print_line(const diagnosis *d)
{
    printf("%s: %s, one-cycle error %.3g %%", d->recording_path, diagnosis_verdict_id(d->verdict),
           d->nominal);
    if (d->causes > 0) {
        printf(" to %.3g %%:", d->extended);
    }
    for (size_t k = 0; k < d->causes; k++) {
        printf("%s %s", k == 0 ? "" : ",", d->cause[k].id);
    }
    putchar('\n');
    (void)fflush(stdout);
}

/* Files first, text last: printed results have been written. */
static bool deliver(const request *r, out_folder *f, const report_input *in, error *e)
{
    json_t *json = json_of_diagnosis(in->d);
    if (r->directory != NULL || r->json_path != NULL) {
        report_firmware(in, json);
    }
    /* All files for DIR go into its stage first. */
    bool ok = f->stage == NULL || report_write(in, f->stage, json, e);
    ok = json_file_place(f, ok ? r->json_path : NULL, json, e) && ok;
    ok = out_folder_close(f, ok, e);
    if (ok && r->count > 1) {
        print_line(in->d);
    } else if (ok && !json_file_is_stdout(r->json_path)) {
        text_print(stdout, in->d);
        if (r->directory != NULL) {
            printf("\n  report: %s/report.html\n", r->directory);
        }
    }
    return ok;
}

/* STATUS_FAILED and STATUS_UNUSABLE keep their meaning. */
static int status_of(diagnosis_verdict v)
{
    static const int status[] = {[VERDICT_CLEAN] = STATUS_DONE,
                                 [VERDICT_EXPLAINED] = 10,
                                 [VERDICT_PARTLY] = 11,
                                 [VERDICT_UNEXPLAINED] = 12};
    return status[v];
}

/* *status: the highest by verdict so far, if that is asked for. */
static bool run(const request *r, const motor *m, const char *path, int *status, error *e)
{
    recording rec;
    diagnosis d;
    out_folder f = {0};
    if (!recording_read(path, &rec, e)) {
        return false;
    }
    if (rec.omega_derived) {
        fprintf(stderr,
                "iqfoc: note: %s has no omega_e_rad_s; speed is computed as the slope of theta_e_rad\n",
                path);
    }
    diagnose_options how = r->options;
    progress shown = progress_begin("diagnose", 0.0, "");
    how.teller = (diagnose_teller){.trace = r->traced ? stderr : NULL, .shown = r->traced ? NULL : &shown};
    /* The files need the series of the diagnosis, one value per row. */
    how.series = r->directory != NULL || r->json_path != NULL;
    bool ok = out_folder_open(&f, r->directory, e) && diagnose(&d, &rec, m, &how, e);
    progress_end(&shown);
    if (ok) {
        const provenance from = {
            .argc = r->argc, .argv = r->argv, .file = {{"recording", path}, {"motor file", r->motor_path}}};
        const report_input in = {&rec, m, &d, &from};
        ok = deliver(r, &f, &in, e);
        const int found = r->exit_verdict ? status_of(d.verdict) : STATUS_DONE;
        *status = found > *status ? found : *status;
        diagnosis_free(&d);
    } else {
        out_folder_close(&f, false, e);
    }
    recording_free(&rec);
    return ok;
}

/* All recordings. One that cannot be used does not stop the others; its message is printed, and the status is its. */
static int run_all(const request *r)
{
    motor m;
    error unread = {0};
    int status = STATUS_DONE;
    int failed = STATUS_DONE;
    if (!motor_read(r->motor_path, &m, &unread)) {
        return error_print(&unread);
    }
    for (int n = 0; n < r->count; n++) {
        error e = {0};
        if (!run(r, &m, r->recordings[n], &status, &e)) {
            failed = error_print(&e);
        }
    }
    return failed != STATUS_DONE ? failed : status;
}

int cmd_diagnose(int argc, char **argv)
{
    error e = {0};
    asked.argc = argc;
    asked.argv = argv;
    options o = options_begin(&about_diagnose, argc, argv);
    if (!options_read(&o, &e) ||
        (!o.helped && !(combination(&o, &asked, &e) && reserve_extended(&asked, &e)))) {
        return error_print(&e);
    }
    return o.helped ? STATUS_DONE : run_all(&asked);
}

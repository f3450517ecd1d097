/* iqfoc watch: trials of the firmware's watch on its model. */
#include "base/json_file.h"
#include "command.h"
#include "options.h"
#include "tune/watch_trial.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a recorder holds after the alarm. */
static const double RECORDED_S = 1.0;

enum { OPT_MOTOR, OPT_RATE, OPT_TRIALS, OPT_CYCLES, OPT_SEED, OPT_JSON, OPT_CHANGE, OPT_OUTPUT };

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file"},
    {"rate", 0, "HZ", "switching frequency; default: 8000"},
    {"trials", 0, "N", "drives for each change; default: 20"},
    {"cycles", 0, "N", "of a drive in which nothing changes; default: 1e6"},
    {"seed", 0, "N", "of the first drive; default: 1"},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text"},
    {"change", 0, "magnet|winding|sensor|dead_time", "with -o: what changes in the drive that is recorded"},
    {"output", 'o', "DIR",
     "no trials, but one drive: what the alarm lets be recorded, rec.csv, and motor.toml"},
    {NULL, 0, NULL, NULL}};

const command_about about_watch = {
    "watch", "--motor M.toml [--rate HZ] [--trials N] [--cycles N] [--json F] | --change C -o DIR",
    "Tries the watch of iqfoc/watch.h: drives with dead time and noise under the tuned controller run\n"
    "varied duty in the switching-level plant, and after half a second the magnet weakens by 5 %,\n"
    "the winding warms by 60 K, a current sensor's gain grows by 2 %, or the dead time doubles. Says\n"
    "how soon that is noted and what it is taken for, and how high the detectors get when nothing\n"
    "changes. With -o one drive is recorded from its alarm on, for iqfoc diagnose.",
    specs};

typedef struct request {
    const char *motor_path, *json_path, *change, *directory;
    double rate, cycles;
    long trials, seed;
} request;

typedef struct results {
    watch_trial of[WATCH_CHANGES];
    watch_clean clean;
} results;

static json_t *trial_json(watch_change change, const watch_trial *t)
{
    json_t *named = json_object();
    for (int g = 0; g <= IQFOC_WATCH_GROUPS; g++) {
        if (t->named[g] > 0 &&
            json_object_set_new(named, watch_group_text[g], json_integer(t->named[g])) != 0) {
            json_free(named);
            return NULL;
        }
    }
    return json_pack("{s:s, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:i, s:o}", "change", watch_change_key[change],
                     "trials", t->trials, "noted", t->noted, "right", t->right, "early", t->early, "median_s",
                     json_number(t->median_s), "latest_s", json_number(t->latest_s), "amount",
                     json_number(t->amount), "since_within_0.1_s", t->since_within, "named", named);
}

static json_t *results_json(const motor *m, const results *r)
{
    json_t *trials = json_array();
    json_t *passed = json_array();
    bool ok = trials != NULL && passed != NULL;
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES && ok; n++) {
        ok = json_array_append_new(trials, trial_json((watch_change)n, &r->of[n])) == 0;
    }
    for (int n = 1; n < WATCH_LEVELS && ok; n++) {
        ok = json_array_append_new(passed, json_integer(r->clean.passed[n])) == 0;
    }
    if (!ok) {
        json_free(trials);
        json_free(passed);
        return NULL;
    }
    return json_pack("{s:i, s:s, s:f, s:f, s:o, s:{s:f, s:i, s:f, s:o}}", "schema", 1, "motor", m->name,
                     "f_pwm_Hz", m->f_pwm_Hz, "noise_pu", WATCH_NOISE, "trials", trials, "clean", "cycles",
                     r->clean.cycles, "alarms", (int)r->clean.alarms, "highest", r->clean.highest, "passed",
                     passed);
}

static void print(const motor *m, const results *r)
{
    printf("%s at %g Hz, noise %g %% of the rated peak a sample\n  %-26s%8s%8s%8s%12s%12s%10s\n", m->name,
           m->f_pwm_Hz, 100.0 * WATCH_NOISE, "what changes", "drives", "noted", "right", "median, s",
           "latest, s", "early");
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES; n++) {
        const watch_trial *t = &r->of[n];
        printf("  %-26s%8d%8d%8d%12.3f%12.3f%10d\n", watch_change_text[n], t->trials, t->noted, t->right,
               t->median_s, t->latest_s, t->early);
    }
    printf("nothing, %.3g cycles: %ld alarms, the highest detector at %.2f of %.2f\n", r->clean.cycles,
           r->clean.alarms, r->clean.highest, IQFOC_WATCH_THRESHOLD);
}

static bool take_change(const request *r, watch_change *change, error *e)
{
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES; n++) {
        if (r->change != NULL && strcmp(r->change, watch_change_key[n]) == 0) {
            *change = (watch_change)n;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "watch: -o needs --change magnet, winding, sensor or dead_time");
}

static bool write_dump(const request *r, const watch_dump *dump, error *e)
{
    out_folder f = {0};
    char path[1100];
    bool ok = out_folder_open(&f, r->directory, e);
    if (ok) {
        (void)snprintf(path, sizeof path, "%s/rec.csv", f.stage);
        ok = recording_write(path, &dump->rows.recording, "iqfoc watch: recorded from its alarm on", e);
    }
    if (ok) {
        (void)snprintf(path, sizeof path, "%s/motor.toml", f.stage);
        ok = motor_write(path, &dump->told, "what the firmware knew at the alarm", e);
    }
    return out_folder_close(&f, ok, e);
}

/* One drive up to its alarm, and what is recorded from there on. */
static bool record(const request *r, const tune_result *design, error *e)
{
    static watch_dump dump;
    watch_change change = WATCH_NOTHING;
    bool ok = take_change(r, &change, e) &&
              watch_trial_dump(design, change, (uint64_t)r->seed, RECORDED_S, &dump, e);
    if (ok && !dump.noted) {
        ok = error_input(e, NULL, 0, 0,
                         "watch: %s was not noted within %g s; another --seed runs another duty",
                         watch_change_text[change], WATCH_CHANGED_S);
    }
    ok = ok && write_dump(r, &dump, e);
    recording_free(&dump.rows.recording);
    if (ok) {
        printf("%s: taken for %s\n  iqfoc diagnose %s/rec.csv --motor %s/motor.toml\n",
               watch_change_text[change], watch_group_text[dump.group], r->directory, r->directory);
    }
    return ok;
}

static bool try_all(const request *r, const tune_result *design, error *e)
{
    static results all;
    bool ok = true;
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES && ok; n++) {
        ok = watch_trial_run(design, (watch_change)n, (int)r->trials, (uint64_t)r->seed, &all.of[n], e);
    }
    ok = ok && watch_clean_run(design, r->cycles, (uint64_t)r->seed + 1000000, &all.clean, e);
    out_folder none = {0};
    ok = ok && json_file_place(&none, r->json_path, results_json(&design->motor, &all), e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        print(&design->motor, &all);
    }
    return ok;
}

static bool watch(const request *r, error *e)
{
    static tune_result design = {.method = TUNE_PI, .disk_wanted = 0.5};
    const tune_tolerances t = {TUNE_TOLERANCE_R, TUNE_TOLERANCE_L, TUNE_TOLERANCE_PSI_F};
    if (!motor_read(r->motor_path, &design.motor, e)) {
        return false;
    }
    design.motor.f_pwm_Hz = r->rate;
    tune_region_of_tolerances(&design.motor, &t, &design.region);
    return tune_design_bandwidth(&design, e) &&
           (r->directory != NULL ? record(r, &design, e) : try_all(r, &design, e));
}

int cmd_watch(int argc, char **argv)
{
    request r = {.rate = 8000.0, .cycles = 1e6, .trials = 20, .seed = 1};
    error e = {0};
    const option_place places[] = {[OPT_MOTOR] = {.text = &r.motor_path, .needed = true},
                                   [OPT_RATE] = {.number = &r.rate, .low = 100.0, .high = 1e6},
                                   [OPT_TRIALS] = {.integer = &r.trials, .low = 1, .high = 100000},
                                   [OPT_CYCLES] = {.number = &r.cycles, .low = 1e3, .high = 1e12},
                                   [OPT_SEED] = {.integer = &r.seed, .low = 0, .high = 1000000000},
                                   [OPT_JSON] = {.text = &r.json_path},
                                   [OPT_CHANGE] = {.text = &r.change},
                                   [OPT_OUTPUT] = {.text = &r.directory}};
    options o = options_begin(&about_watch, argc, argv);
    bool ok = options_read(&o, places, &e);
    if (ok && !o.helped) {
        ok = options_complete(&o, places, &e) && watch(&r, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}

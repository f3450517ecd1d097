/* iqfoc watch: trials of the firmware's change detector. */
#include "base/confine.h"
#include "base/json_file.h"
#include "command.h"
#include "drive_emulated.h"
#include "options.h"
#include "tune/tune_watch.h"
#include "tune/watch_results.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Rows of a recorder after the alarm. */
static const double RECORDED_S = 1.0;

typedef struct request {
    const char *motor_path, *diagnosis_path, *json_path, *change, *condition, *directory;
    drive_emulated_choice emulated; /* no target: the firmware in this program */
    double rate, cycles;
    long trials, seed;
} request;

static request asked = {.rate = 8000.0, .cycles = 2e5, .trials = 20, .seed = 1};

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path, .needed = true},
    {"diagnosis", 0, "D.json",
     "output of `iqfoc diagnose --json`: the firmware's model, and the detector's noise and uncertainty",
     .text = &asked.diagnosis_path},
    {"rate", 0, "HZ", "switching frequency; default: 8000", .number = &asked.rate, .low = 100.0, .high = 1e6},
    {"trials", 0, "N", "drives for each change; default: 20; 0: only the drive without a change",
     .integer = &asked.trials, .low = 0, .high = 100000},
    {"cycles", 0, "N", "cycles of the drive without a change, of each condition; default: 2e5",
     .number = &asked.cycles, .low = 1e3, .high = 1e12},
    {"condition", 0, "constant|ripple_1|ripple_3|temperature|saturation_3|saturation_10|load_steps|all",
     "operating condition of the drive without a change; default: all", .text = &asked.condition},
    {"seed", 0, "N", "seed of the first drive; default: 1", .integer = &asked.seed, .low = 0,
     .high = 1000000000},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {"change", 0, "magnet|winding|sensor|dead_time|phase|rotor", "with -o: the change of the recorded drive",
     .text = &asked.change},
    {"output", 'o', "DIR",
     "instead of trials: one drive's recording from the alarm on, rec.csv, and motor.toml",
     .text = &asked.directory},
    {"target", 0, "T",
     "with -o: the firmware runs in QEMU, cortex-m4 or rv32; its recorder writes rec.uart,\nfor iqfoc "
     "record",
     .text = &asked.emulated.target},
    {"image", 0, "F.elf", "the image for --target (default: the one built with this program)",
     .text = &asked.emulated.image},
    {.name = NULL}};

const command_about about_watch = {
    "watch",
    "--motor M.toml [--diagnosis D.json] [--rate HZ] [--trials N] [--cycles N] [--json F] | --change C "
    "[--target T] -o DIR",
    "Tries the change detector of iqfoc/watch.h. Drives with dead time and noise under the tuned\n"
    "controller run a varied duty in the switching-level plant. After half a second the magnet weakens\n"
    "by 5 %, the winding warms by 60 K, a current sensor's gain grows by 2 %, the dead time doubles, one\n"
    "phase's resistance grows by 50 %, or the rotor becomes eccentric (5 % of flux).\n"
    "An angle sensor that is off, slips or is eccentric is tried too, with the observer next to it\n"
    "(iqfoc/watch_angle.h).\n"
    "Prints the time to the alarm, the named group, and the false alarms without a change: with constant\n"
    "conditions, ripple of the DC link, temperature swings (R and psi_f adapted), saturation (the fall of\n"
    "L stated to the detector), and load steps.\n"
    "With -o one drive is recorded from its alarm on, for iqfoc diagnose.",
    specs};

static bool take_change(const request *r, watch_change *change, error *e)
{
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES; n++) {
        if (r->change != NULL && strcmp(r->change, watch_change_key[n]) == 0) {
            *change = (watch_change)n;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0,
                       "watch: -o needs --change magnet, winding, sensor, dead_time, phase or rotor");
}

/* ---- The firmware in an emulator ---- */

typedef struct emulated_firmware {
    drive_emulated machine;
    drive_emulated_choice choice;
} emulated_firmware;

static bool start_emulated(void *context, const tuned_firmware_config_t *config, const motor *model,
                           drive_firmware *calls, error *e)
{
    emulated_firmware *f = context;
    *calls = drive_firmware_emulated(&f->machine);
    return drive_emulated_start(&f->machine, &f->choice, model, e) &&
           drive_emulated_tune(&f->machine, config, e);
}

static bool group_emulated(void *context, iqfoc_watch_group_t *group, error *e)
{
    emulated_firmware *f = context;
    pil_watched_t watched;
    if (!drive_emulated_watched(&f->machine, &watched, e)) {
        return false;
    }
    *group = (iqfoc_watch_group_t)watched.group;
    return true;
}

/* ---- One drive up to its alarm, and the recording from there on ---- */

static bool run_dump(const request *r, const tune_result *design, watch_change change, const char *uart,
                     watch_dump *dump, error *e)
{
    static emulated_firmware f;
    const watch_target target = {&f, start_emulated, group_emulated};
    const uint64_t seed = (uint64_t)r->seed;
    if (r->emulated.target == NULL) {
        return watch_trial_dump(design, change, seed, RECORDED_S, NULL, dump, e);
    }
    f.choice = r->emulated;
    f.choice.uart = uart;
    f.choice.at_alarm = true;
    const bool ok = watch_trial_dump(design, change, seed, RECORDED_S, &target, dump, e) &&
                    drive_emulated_finish(&f.machine, e);
    drive_emulated_stop(&f.machine);
    return ok;
}

static bool write_dump(const request *r, const char *stage, const watch_dump *dump, error *e)
{
    char path[1100];
    (void)snprintf(path, sizeof path, "%s/rec.csv", stage);
    const bool ok = r->emulated.target != NULL ||
                    recording_write(path, &dump->rows.recording, "iqfoc watch: recorded from the alarm", e);
    (void)snprintf(path, sizeof path, "%s/motor.toml", stage);
    return ok && motor_write(path, &dump->model, "the firmware's model at the alarm", e);
}

static void print_dump(const request *r, watch_change change, const watch_dump *dump)
{
    printf("%s: named %s, %.3f s after the change\n", watch_change_text[change],
           watch_group_text[dump->group], dump->alarm_s);
    if (r->emulated.target != NULL) {
        printf("  iqfoc record --port %s/rec.uart -o %s/rec.csv\n", r->directory, r->directory);
    }
    printf("  iqfoc diagnose %s/rec.csv --motor %s/motor.toml\n", r->directory, r->directory);
}

static bool record(const request *r, const tune_result *design, error *e)
{
    static watch_dump dump;
    watch_change change = WATCH_NOTHING;
    char uart[1100];
    out_folder f = {0};
    bool ok = take_change(r, &change, e) && out_folder_open(&f, r->directory, e);
    if (ok) {
        (void)snprintf(uart, sizeof uart, "%s/rec.uart", f.stage);
        ok = run_dump(r, design, change, uart, &dump, e) &&
             (dump.noted ||
              error_input(e, NULL, 0, 0,
                          "watch: no alarm for %s within %g s; try another --seed for another duty",
                          watch_change_text[change], WATCH_CHANGED_S)) &&
             write_dump(r, f.stage, &dump, e);
    }
    ok = out_folder_close(&f, ok, e);
    recording_free(&dump.rows.recording);
    if (ok) {
        print_dump(r, change, &dump);
    }
    return ok;
}

static bool take_conditions(const request *r, bool ran[WATCH_CONDITIONS], error *e)
{
    bool any = false;
    for (int n = 0; n < WATCH_CONDITIONS; n++) {
        ran[n] = r->condition == NULL || strcmp(r->condition, "all") == 0 ||
                 strcmp(r->condition, watch_condition_key[n]) == 0;
        any = any || ran[n];
    }
    return any || error_input(e, NULL, 0, 0,
                              "watch: --condition %s: expected constant, ripple_1, ripple_3, temperature, "
                              "saturation_3, saturation_10, load_steps or all",
                              r->condition);
}

static bool try_all(const request *r, const tune_result *design, error *e)
{
    static watch_results all;
    const uint64_t seed = (uint64_t)r->seed;
    all.tried = r->trials > 0;
    all.fall = tune_fall_of(&design->motor).flux;
    bool ok = take_conditions(r, all.ran, e);
    for (int n = 0; n < WATCH_CONDITIONS && ok; n++) {
        ok = !all.ran[n] ||
             watch_clean_run(design, (watch_condition)n, r->cycles, seed + 1000000, &all.clean[n], e);
    }
    for (int n = WATCH_NOTHING + 1; n < WATCH_CHANGES && ok && all.tried; n++) {
        ok = watch_trial_run(design, (watch_change)n, (int)r->trials, seed, &all.of[n], e);
    }
    for (int n = 0; n < WATCH_ANGLE_FAULTS && ok && all.tried; n++) {
        ok = watch_angle_trial_run(design, (iqfoc_watch_angle_fault_t)n, (int)r->trials, seed, &all.angle[n],
                                   e);
    }
    ok = ok && (!all.tried ||
                (adapt_trial_run(design, false, WATCH_WARMING_S, WATCH_ADAPTED_S, seed, &all.plain, e) &&
                 adapt_trial_run(design, true, WATCH_WARMING_S, WATCH_ADAPTED_S, seed, &all.adapted, e)));
    out_folder none = {0};
    ok = ok && json_file_place(&none, r->json_path, watch_results_json(&design->motor, &all), e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        watch_results_print(&design->motor, &all, stdout);
    }
    return ok;
}

/* The uncertainty set of the model, and with a diagnosis the detector's noise and uncertainty. */
static bool take_region(const request *r, tune_result *design, error *e)
{
    const tune_tolerances t = {TUNE_TOLERANCE_R, TUNE_TOLERANCE_L, TUNE_TOLERANCE_PSI_F};
    if (r->diagnosis_path == NULL) {
        tune_region_of_tolerances(&design->motor, &t, &design->region);
        return tune_design_bandwidth(design, e);
    }
    if (!tune_region_of_diagnosis(&design->motor, r->diagnosis_path, &t, &design->region, e) ||
        !tune_design_bandwidth(design, e)) {
        return false;
    }
    const tune_watch known = tune_watch_of(design);
    return known.none == NULL ||
           error_input(e, r->diagnosis_path, 0, 0, "no change detector by this: %s", known.none);
}

static bool watch(const request *r, error *e)
{
    static tune_result design = {.method = TUNE_PI, .disk_wanted = 0.5};
    if (!motor_read(r->motor_path, &design.motor, e)) {
        return false;
    }
    design.motor.f_pwm_Hz = r->rate;
    return take_region(r, &design, e) &&
           (r->directory != NULL ? record(r, &design, e) : try_all(r, &design, e));
}

int cmd_watch(int argc, char **argv)
{
    error e = {0};
    options o = options_begin(&about_watch, argc, argv);
    bool ok = options_read(&o, &e);
    if (ok && asked.emulated.target == NULL) {
        confine(CONFINE_TO_FILES);
    }
    if (ok && !o.helped) {
        ok = options_complete(&o, &e) &&
             (asked.emulated.target == NULL || asked.directory != NULL ||
              error_input(&e, NULL, 0, 0, "watch: --target needs --change and -o")) &&
             watch(&asked, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}

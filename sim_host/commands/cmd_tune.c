/* iqfoc tune: a current controller with margins, from a motor file and what a diagnosis knows of it. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "options.h"
#include "tune/tune_report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    OPT_MOTOR,
    OPT_DIAGNOSIS,
    OPT_RATIO,
    OPT_METHOD,
    OPT_MARGIN,
    OPT_TOLERANCE,
    OPT_DRIVES,
    OPT_SEED,
    OPT_JSON,
    OPT_OUTPUT
};

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file"},
    {"diagnosis", 0, "D.json", "what `iqfoc diagnose --json` wrote: the machine and how sure it is"},
    {"ratio", 0, "N",
     "design for so many control cycles per electrical turn at n_max,\nand not for the file's f_pwm_Hz"},
    {"method", 0, "pi|deadbeat", "how the reference is followed; default: pi"},
    {"margin", 0, "D", "the least disk margin; default: 0.5"},
    {"tolerance", 0, "R,L,PSI", "percent, where the diagnosis knows nothing; default: 30,30,5"},
    {"drives", 0, "N", "drives of the region that are tried in the plant; default: 50"},
    {"seed", 0, "N", "of the drives drawn; default: 1"},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text"},
    {"output", 'o', "DIR", "the page and the firmware's header, iqfoc_tuned.h"},
    {NULL, 0, NULL, NULL}};

const command_about about_tune = {
    "tune", "--motor M.toml [--diagnosis D.json] [--ratio N] [--method pi|deadbeat] [-o DIR] [--json F]",
    "Designs the current controller of iqfoc/tuned_control.h: the highest bandwidth whose worst disk\n"
    "margin, at every speed to n_max and for every machine of the region that the diagnosis leaves,\n"
    "is what is asked for. Says the margins and what limits them, tries drives of the region in the\n"
    "switching-level plant, and compares with the library's other controllers.",
    specs};

typedef struct request {
    const char *motor_path, *diagnosis_path, *method, *json_path, *directory;
    double ratio, margin, tolerance[3];
    size_t tolerances;
    long drives, seed;
    bool compares; /* page and JSON show the other controllers, the text does not */
} request;

static bool take_method(const request *r, tune_method *method, error *e)
{
    for (int n = 0; n < 2; n++) {
        if (r->method == NULL || strcmp(r->method, tune_method_text[n]) == 0) {
            *method = (tune_method)n;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "tune: --method %s: expected pi or deadbeat", r->method);
}

/* The library turns by a third of a turn per cycle at most. */
static bool speed_fits(const motor *m, error *e)
{
    const double per_turn = m->f_pwm_Hz / (m->n_max_rpm / 60.0 * m->pole_pairs);
    return per_turn >= 3.0 || motor_refuse(m->path, "f_pwm_Hz", e,
                                           "f_pwm_Hz gives %.3g control cycles per electrical turn at "
                                           "n_max_rpm; expected at least 3, which "
                                           "needs f_pwm_Hz = %.5g",
                                           per_turn, 3.0 * m->n_max_rpm / 60.0 * m->pole_pairs);
}

static bool design(const request *r, tune_report *t, error *e)
{
    tune_result *result = &t->result;
    const tune_tolerances tolerances =
        r->tolerances == 0
            ? (tune_tolerances){TUNE_TOLERANCE_R, TUNE_TOLERANCE_L, TUNE_TOLERANCE_PSI_F}
            : (tune_tolerances){0.01 * r->tolerance[0], 0.01 * r->tolerance[1], 0.01 * r->tolerance[2]};
    if (!motor_read(r->motor_path, &result->motor, e) || !take_method(r, &result->method, e)) {
        return false;
    }
    if (r->ratio > 0.0) {
        result->motor.f_pwm_Hz = r->ratio * result->motor.n_max_rpm / 60.0 * result->motor.pole_pairs;
    }
    result->disk_wanted = r->margin;
    t->diagnosis_path = r->diagnosis_path;
    if (!speed_fits(&result->motor, e)) {
        return false;
    }
    if (r->diagnosis_path == NULL) {
        tune_region_of_tolerances(&result->motor, &tolerances, &result->region);
    } else if (!tune_region_of_diagnosis(&result->motor, r->diagnosis_path, &tolerances, &result->region,
                                         e)) {
        return false;
    }
    return tune_design_find(result, e) &&
           tune_trial_run(result, (int)r->drives, (uint64_t)r->seed, &t->trial, e) &&
           (!r->compares || tune_compare(result, &tolerances, &t->comparison, e));
}

static bool tune(const request *r, error *e)
{
    static tune_report t;
    out_folder f = {0};
    bool ok = out_folder_open(&f, r->directory, e) && design(r, &t, e) &&
              (f.stage == NULL || (tune_report_page(&t, f.stage, e) && tune_report_header(&t, f.stage, e))) &&
              json_file_place(&f, r->json_path, tune_report_json(&t), e);
    ok = out_folder_close(&f, ok, e);
    if (ok && !json_file_is_stdout(r->json_path)) {
        tune_report_print(&t, stdout);
        if (r->directory != NULL) {
            printf("\nThe page: %s/index.html; the firmware's header: %s/iqfoc_tuned.h\n", r->directory,
                   r->directory);
        }
    }
    return ok;
}

int cmd_tune(int argc, char **argv)
{
    request r = {.margin = 0.5, .drives = 50, .seed = 1};
    error e = {0};
    const option_place places[] = {[OPT_MOTOR] = {.text = &r.motor_path, .needed = true},
                                   [OPT_DIAGNOSIS] = {.text = &r.diagnosis_path},
                                   [OPT_RATIO] = {.number = &r.ratio, .low = 3.0, .high = 1000.0},
                                   [OPT_METHOD] = {.text = &r.method},
                                   [OPT_MARGIN] = {.number = &r.margin, .low = 0.05, .high = 1.5},
                                   [OPT_TOLERANCE] = {.number = r.tolerance,
                                                      .count = &r.tolerances,
                                                      .most = 3,
                                                      .low = 0.0,
                                                      .high = 90.0},
                                   [OPT_DRIVES] = {.integer = &r.drives, .low = 1, .high = 100000},
                                   [OPT_SEED] = {.integer = &r.seed, .low = 0, .high = 1000000000},
                                   [OPT_JSON] = {.text = &r.json_path},
                                   [OPT_OUTPUT] = {.text = &r.directory}};
    options o = options_begin(&about_tune, argc, argv);
    bool ok = options_read(&o, places, &e);
    r.compares = r.directory != NULL || r.json_path != NULL;
    if (ok && !o.helped) {
        ok = options_complete(&o, places, &e) &&
             (r.tolerances == 0 || r.tolerances == 3 ||
              error_input(&e, NULL, 0, 0,
                          "tune: --tolerance: expected three numbers: of R, of L and of psi_f")) &&
             tune(&r, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}

/* iqfoc tune: designs a current controller with margins, from a motor file and a diagnosis. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "command.h"
#include "options.h"
#include "tune/tune_report.h"

#include <stdio.h>
#include <string.h>

typedef struct request {
    const char *motor_path, *method, *json_path, *directory;
    double tolerance[3];
    size_t tolerances;
    tune_choice choice;
} request;

static request asked;

static const option_spec specs[] = {
    {"motor", 'm', "M.toml", "the motor file", .text = &asked.motor_path, .needed = true},
    {"diagnosis", 0, "D.json", "output of `iqfoc diagnose --json`: the machine with its uncertainty",
     .text = &asked.choice.diagnosis_path},
    {"ratio", 0, "N", "SFFR at n_max to design for, instead of the file's f_pwm_Hz",
     .number = &asked.choice.ratio, .low = 3.0, .high = 1000.0},
    {"method", 0, "pi|deadbeat", "filter of the reference; default: pi", .text = &asked.method},
    {"updates", 0, "1|2",
     "updates a carrier period; 2: f_pwm_Hz is the carrier's, a control cycle is half of it",
     .integer = &asked.choice.updates, .low = 1, .high = 2},
    {"margin", 0, "D", "required disk margin; default: 0.5", .number = &asked.choice.margin, .low = 0.05,
     .high = 1.5},
    {"tolerance", 0, "R,L,PSI", "percent, for values without a diagnosis; default: 30,30,5",
     .number = asked.tolerance, .count = &asked.tolerances, .most = 3, .low = 0.0, .high = 90.0},
    {"run-up", 0, "S",
     "fastest run-up from standstill to n_max, s, for observer and speed control; default: 1",
     .number = &asked.choice.run_up_s, .low = 1e-4, .high = 1e6},
    {"inertia", 0, "J", "inertia of rotor and load, kg m2: designs the speed control too",
     .number = &asked.choice.J_kgm2, .low = 1e-9, .high = 1e9},
    {"drives", 0, "N", "drives of the uncertainty set to simulate; default: 50",
     .integer = &asked.choice.drives, .low = 1, .high = 100000},
    {"seed", 0, "N", "seed of the drawn drives; default: 1", .integer = &asked.choice.seed, .low = 0,
     .high = 1000000000},
    {"json", 0, "F", "write the results to file F; - is stdout, without the text", .text = &asked.json_path,
     .written = true},
    {"output", 'o', "DIR", "folder of the report page and the firmware header iqfoc_tuned.h",
     .text = &asked.directory},
    {.name = NULL}};

const command_about about_tune = {
    "tune", "--motor M.toml [--diagnosis D.json] [--ratio N] [--method pi|deadbeat] [-o DIR] [--json F]",
    "Designs the current controller of iqfoc/tuned_control.h with the highest bandwidth whose worst disk\n"
    "margin reaches the requirement, at every speed to n_max and for every machine of the uncertainty\n"
    "set. Prints the margins and the limiting machine, simulates drives of the set with the\n"
    "switching-level plant, and compares with the library's other controllers. Also designs the observer\n"
    "of iqfoc/observer.h, with the margins without an angle sensor, and with --inertia the speed control\n"
    "of iqfoc/speed_control.h.",
    specs};

static bool take_method(request *r, error *e)
{
    for (int n = 0; n < 2; n++) {
        if (r->method == NULL || strcmp(r->method, tune_method_text[n]) == 0) {
            r->choice.method = (tune_method)n;
            return true;
        }
    }
    return error_input(e, NULL, 0, 0, "tune: --method %s: expected pi or deadbeat", r->method);
}

static bool take_tolerances(request *r, error *e)
{
    if (r->tolerances == 3) {
        r->choice.tolerances =
            (tune_tolerances){0.01 * r->tolerance[0], 0.01 * r->tolerance[1], 0.01 * r->tolerance[2]};
    }
    return r->tolerances == 0 || r->tolerances == 3 ||
           error_input(e, NULL, 0, 0, "tune: --tolerance needs three numbers, for R, L and psi_f; it has %zu",
                       r->tolerances);
}

static bool design(const request *r, tune_report *t, error *e)
{
    motor m;
    return motor_read(r->motor_path, &m, e) && tune_report_make(t, &m, &r->choice, e);
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
            printf("\nPage: %s/index.html; firmware header: %s/iqfoc_tuned.h\n", r->directory, r->directory);
        }
    }
    return ok;
}

int cmd_tune(int argc, char **argv)
{
    tune_choice *c = &asked.choice;
    error e = {0};
    *c = tune_choice_usual();
    options o = options_begin(&about_tune, argc, argv);
    bool ok = options_read(&o, &e);
    c->compares = asked.directory != NULL || asked.json_path != NULL;
    if (ok && !o.helped) {
        ok = options_complete(&o, &e) && take_tolerances(&asked, &e) && take_method(&asked, &e) &&
             tune(&asked, &e);
    }
    return ok ? STATUS_DONE : error_print(&e);
}

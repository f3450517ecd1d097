/* The design of a current controller, and the controller with its change detector. */
#include "tune/tuned_drive.h"

#include "base/json_file.h"
#include "base/out_folder.h"
#include "handles.h"
#include "tune/tune_report.h"
#include "tune/watch_trial.h"

#include "iqfoc/watch.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct py_tuned {
    py_firmware firmware;
    tuned_firmware_t control;
};

py_design *py_tune(const motor *m, const py_tune_choice *choice, const char *diagnosis_path, error *e)
{
    const tune_choice c = {.diagnosis_path = diagnosis_path,
                           .ratio = choice->ratio,
                           .method = choice->deadbeat ? TUNE_DEADBEAT : TUNE_PI,
                           .updates = 1,
                           .margin = choice->margin,
                           .run_up_s = choice->run_up_s,
                           .J_kgm2 = choice->inertia_kgm2,
                           .tolerances = {choice->tolerance[0], choice->tolerance[1], choice->tolerance[2]},
                           .drives = choice->drives,
                           .seed = choice->seed,
                           .compares = choice->compares};
    py_design *d = calloc(1, sizeof *d);
    if (d == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    if (!tune_report_make(d, m, &c, e)) {
        free(d);
        return NULL;
    }
    d->diagnosis_path = NULL; /* the caller's */
    return d;
}

void py_design_free(py_design *d)
{
    free(d);
}

bool py_design_json(const py_design *d, const char *path, error *e)
{
    out_folder none = {0};
    return json_file_place(&none, path, tune_report_json(d), e);
}

bool py_design_text(const py_design *d, const char *path, error *e)
{
    FILE *out = fopen(path, "w");
    if (out == NULL) {
        return error_failure(e, errno, "%s: cannot be written", path);
    }
    tune_report_print(d, out);
    return fclose(out) == 0 || error_failure(e, errno, "%s: cannot be written", path);
}

bool py_design_report(const py_design *d, const char *directory, error *e)
{
    out_folder f = {0};
    const bool ok = out_folder_open(&f, directory, e) && tune_report_page(d, f.stage, e) &&
                    tune_report_header(d, f.stage, e);
    return out_folder_close(&f, ok, e);
}

motor *py_design_motor(const py_design *d)
{
    error e = {0};
    return py_motor_keep(&d->result.motor, d->result.motor.name, &e);
}

/* The detector of the design, with this noise. */
static bool add_watch(py_tuned *t, const py_design *d, double noise_A, error *e)
{
    tune_result r = d->result;
    if (noise_A > 0.0) {
        r.region.noise_A = noise_A;
    }
    const tune_watch known = tune_watch_of(&r);
    if (known.none != NULL) {
        return error_input(e, NULL, 0, 0, "no change detector: %s", known.none);
    }
    tuned_drive_watch(&t->control, &r.motor, &r.design.machine, &known);
    return true;
}

py_tuned *py_tuned_new(const py_design *d, bool watched, double noise_A, error *e)
{
    py_tuned *t = calloc(1, sizeof *t);
    if (t == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    if (!tuned_drive_init(&t->control, &d->result.motor, &d->result.design, e) ||
        (watched && !add_watch(t, d, noise_A, e))) {
        free(t);
        return NULL;
    }
    py_firmware_begin(&t->firmware, tuned_drive_firmware(&t->control));
    return t;
}

void py_tuned_free(py_tuned *t)
{
    free(t);
}

py_firmware *py_tuned_firmware(py_tuned *t)
{
    return &t->firmware;
}

void py_tuned_state(const py_tuned *t, py_watched *state)
{
    const iqfoc_watch_t *w = &t->control.watch;
    const iqfoc_tuned_state_t *s = &t->control.state;
    *state = (py_watched){.alarm = (t->control.status & TUNED_FIRMWARE_ALARM) != 0,
                          .group = w->group == IQFOC_WATCH_NONE ? NULL : watch_group_text[w->group],
                          .amount = ldexp(w->amount_q16, -16),
                          .since = (double)w->since * IQFOC_WATCH_BLOCK_CYCLES,
                          .cycles = (double)w->blocks * IQFOC_WATCH_BLOCK_CYCLES,
                          .i_dq = {s->i.d, s->i.q},
                          .drift_dq = {s->drift.d, s->drift.q}};
}

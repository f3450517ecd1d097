/* A diagnosis, kept with its series until Python has read it. */
#include "base/json_file.h"
#include "base/out_folder.h"
#include "diagnose/diagnose.h"
#include "diagnose/show/report.h"
#include "diagnose/tell/json.h"
#include "diagnose/tell/text.h"
#include "handles.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

struct py_diagnosis {
    diagnosis d;
    const recording *rec;
    const motor *nominal;
};

static bool take_skips(diagnose_options *o, size_t skips, const char *const *skip, error *e)
{
    for (size_t k = 0; k < skips; k++) {
        const hypothesis_set set = hypotheses_of_cause(skip[k]);
        if (set == 0) {
            return error_input(e, NULL, 0, 0, "skip: '%s' is no cause id", skip[k]);
        }
        o->skip |= set;
    }
    return true;
}

py_diagnosis *py_diagnose(const recording *r, const motor *m, size_t skips, const char *const *skip, error *e)
{
    diagnose_options o = {.series = true};
    py_diagnosis *p = calloc(1, sizeof *p);
    if (p == NULL) {
        error_failure(e, 0, "out of memory");
        return NULL;
    }
    if (!take_skips(&o, skips, skip, e) || !diagnose(&p->d, r, m, &o, e)) {
        free(p);
        return NULL;
    }
    p->rec = r;
    p->nominal = m;
    return p;
}

void py_diagnosis_free(py_diagnosis *p)
{
    if (p != NULL) {
        diagnosis_free(&p->d);
        free(p);
    }
}

bool py_diagnosis_text(const py_diagnosis *p, const char *path, error *e)
{
    FILE *out = fopen(path, "w");
    if (out == NULL) {
        return error_failure(e, errno, "%s: cannot be written", path);
    }
    text_print(out, &p->d);
    return fclose(out) == 0 || error_failure(e, errno, "%s: cannot be written", path);
}

/* With what the firmware gains, as the command has it. Opens the folder if there is one. */
static bool deliver(const py_diagnosis *p, const char *directory, const char *json_path, error *e)
{
    const provenance from = {.file = {{"recording", p->rec->path}, {"motor file", p->nominal->path}}};
    const report_input in = {p->rec, p->nominal, &p->d, &from};
    out_folder f = {0};
    if (!out_folder_open(&f, directory, e)) {
        return false;
    }
    json_t *json = json_of_diagnosis(&p->d);
    report_firmware(&in, json);
    bool ok = f.stage == NULL || report_write(&in, f.stage, json, e);
    ok = json_file_place(&f, ok ? json_path : NULL, json, e) && ok;
    return out_folder_close(&f, ok, e);
}

bool py_diagnosis_json(const py_diagnosis *p, const char *path, error *e)
{
    return deliver(p, NULL, path, e);
}

bool py_diagnosis_report(const py_diagnosis *p, const char *directory, error *e)
{
    return deliver(p, directory, NULL, e);
}

motor *py_diagnosis_motor(const py_diagnosis *p)
{
    error e = {0};
    return py_motor_keep(&p->d.extended_motor, p->d.extended_motor.name, &e);
}

void py_diagnosis_series(const py_diagnosis *p, double *const *column, double *held_out)
{
    const vec_ab *const series[] = {p->d.error_nominal, p->d.error_extended, p->d.free_nominal,
                                    p->d.free_extended};
    for (size_t n = 0; n < sizeof series / sizeof series[0]; n++) {
        for (size_t k = 0; k < p->rec->rows; k++) {
            column[2 * n][k] = series[n][k].alpha;
            column[2 * n + 1][k] = series[n][k].beta;
        }
    }
    for (size_t k = 0; k < p->rec->rows; k++) {
        held_out[k] = p->d.held_out[k];
    }
}

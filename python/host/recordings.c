/* Recordings: read, made of columns, simulated, imported. Each keeps the name that messages call it by. */
#define _XOPEN_SOURCE 700 /* strdup */

#include "data/recording.h"

#include "data/recording_columns.h"
#include "drive/drive_scenario.h"
#include "drive/firmware_host.h"
#include "import/convert.h"
#include "import/preset.h"
#include "interface.h"
#include "plant/plant_effect.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* An empty one of that name; NULL with *e set. */
static recording *begin(const char *label, error *e)
{
    recording *r = calloc(1, sizeof *r);
    char *name = strdup(label);
    if (r == NULL || name == NULL) {
        free(r);
        free(name);
        error_failure(e, 0, "%s: out of memory", label);
        return NULL;
    }
    r->path = name;
    return r;
}

/* What was made, under the name that `r` has had since it was begun. */
static recording *finish(recording *r, const char *name, bool ok)
{
    r->path = name;
    if (!ok) {
        py_recording_free(r);
        return NULL;
    }
    return r;
}

void py_recording_free(recording *r)
{
    if (r != NULL) {
        free((char *)r->path); /* its own */
        recording_free(r);
        free(r);
    }
}

recording *py_recording_keep(recording *made, const char *label, bool ok, error *e)
{
    recording *r = ok ? begin(label, e) : NULL;
    if (r == NULL) {
        recording_free(made);
        return NULL;
    }
    const char *called = r->path;
    *r = *made;
    r->path = called;
    return r;
}

recording *py_recording_read(const char *path, error *e)
{
    recording *r = begin(path, e);
    const char *name = r != NULL ? r->path : NULL;
    return r != NULL ? finish(r, name, recording_read(name, r, e)) : NULL;
}

recording *py_recording_make(const char *label, size_t rows, size_t count, const char *const *name,
                             const double *const *value, error *e)
{
    recording *r = begin(label, e);
    const char *called = r != NULL ? r->path : NULL;
    return r != NULL ? finish(r, called, recording_make(r, called, rows, count, name, value, e)) : NULL;
}

/* ---- simulated ---- */

typedef struct notes {
    char *text;
    size_t size;
} notes;

static void note(void *context, size_t run, uint32_t status)
{
    const notes *n = context;
    char words[160];
    const size_t used = strlen(n->text);
    snprintf(n->text + used, n->size - used, "run %zu, settling included: %s\n", run,
             drive_status_text(status, words, sizeof words));
}

static bool simulate(const motor *m, const scenario *s, size_t effects, const char *const *effect, long seed,
                     notes *report, drive_recording *out, error *e)
{
    drive_host host;
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    plant_config c = drive_scenario_plant(m, s);
    for (size_t k = 0; k < effects; k++) {
        if (!plant_effect_apply(&c, effect[k], e)) {
            return false;
        }
    }
    const drive_scenario all = {m, s, &c, seed, &firmware, note, report};
    return drive_scenario_run(&all, out, e);
}

recording *py_recording_simulate(const motor *m, const char *scenario_path, size_t effects,
                                 const char *const *effect, long seed, char *text, size_t size, error *e)
{
    scenario s;
    notes report = {text, size};
    drive_recording out = {.run = 0};
    recording *r = begin("simulation", e);
    text[0] = '\0';
    if (r == NULL) {
        return NULL;
    }
    const char *name = r->path;
    bool ok = scenario_read(scenario_path, &s, e);
    if (ok) {
        ok = drive_scenario_plain(&s, scenario_path, e) &&
             simulate(m, &s, effects, effect, seed, &report, &out, e);
        scenario_free(&s);
        *r = out.recording;
        ok = ok && (recording_find_stretches(r) || error_failure(e, 0, "out of memory"));
    }
    return finish(r, name, ok);
}

/* ---- imported ---- */

recording *py_recording_import(const char *log, const char *map_path, const char *preset_name, const motor *m,
                               size_t rows, size_t count, const char *const *name, const double *const *value,
                               error *e)
{
    import_map map;
    if (map_path != NULL) {
        if (!map_read(map_path, &map, e)) {
            return NULL;
        }
    } else {
        const preset *p = preset_find(preset_name, e);
        if (p == NULL) {
            return NULL;
        }
        map = preset_map(p);
    }
    recording *r = begin(log, e);
    if (r == NULL) {
        return NULL;
    }
    log_table t;
    const char *called = r->path;
    const bool open = count > 0 ? log_table_hold(&t, called, count, name, value, rows, e)
                                : map_open_log(&map, &t, called, e);
    const bool ok = open && convert_log(&t, &map, m, r, e);
    log_table_close(&t);
    return finish(r, called, ok);
}

/* ---- looked at ---- */

bool py_recording_write(const recording *r, const char *path, const char *comment, error *e)
{
    return recording_write(path, r, comment, e);
}

size_t py_recording_rows(const recording *r)
{
    return r->rows;
}

double py_recording_T_s(const recording *r)
{
    return r->T_s;
}

bool py_recording_omega_derived(const recording *r)
{
    return r->omega_derived;
}

const char *py_recording_column_name(size_t column)
{
    return column < COL_COUNT ? recording_column_name((column_id)column) : NULL;
}

bool py_recording_column(const recording *r, size_t column, double *out)
{
    const column_id id = (column_id)column;
    recording columns_of = *r; /* a copy, as recording_column wants a struct that it may change */
    if (id == COL_RUN) {
        for (size_t k = 0; r->run != NULL && k < r->rows; k++) {
            out[k] = (double)r->run[k];
        }
        return r->run != NULL;
    }
    const double *values = *recording_column(&columns_of, id);
    if (values == NULL || (id == COL_I_C && !r->i_c_measured) || (id == COL_OMEGA && r->omega_derived)) {
        return false;
    }
    memcpy(out, values, r->rows * sizeof *values);
    return true;
}

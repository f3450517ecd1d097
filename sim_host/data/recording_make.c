/* A recording from columns in memory: what the reader asks of a file, asked of numbers (recording.h). */
#include "recording.h"

#include "recording_columns.h"
#include "recording_missing.h"
#include "speed_from_angle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct source {
    const char *path;
    size_t rows;
    const double *of[COL_COUNT]; /* NULL: it has no such column */
    bool have[COL_COUNT];
} source;

/* Which of the names are columns of a recording. */
static bool take_names(source *in, size_t count, const char *const *name, const double *const *value,
                       error *e)
{
    recording_missing missing = {.list = ""};
    char found[256] = "";
    for (size_t n = 0; n < count; n++) {
        const column_id id = recording_column_find(name[n], strlen(name[n]));
        const size_t used = strlen(found);
        snprintf(found + used, sizeof found - used, "%s%s", used > 0 ? "," : "", name[n]);
        if (id == COL_COUNT) {
            recording_missing_note(&missing, name[n], strlen(name[n]));
            continue;
        }
        if (in->have[id]) {
            return error_input(e, in->path, 0, 0, "column %s is there twice; remove one", name[n]);
        }
        in->have[id] = true;
        in->of[id] = value[n];
    }
    recording_missing_find(&missing, in->have);
    if (missing.list[0] != '\0') {
        char words[512];
        recording_missing_words(&missing, found, strlen(found), words, sizeof words);
        return error_input(e, in->path, 0, 0, "%s", words);
    }
    if (in->rows == 0) {
        return error_input(e, in->path, 0, 0, "no rows; expected some");
    }
    recording_columns_whole(in->have);
    return true;
}

static bool check_column(const source *in, column_id id, error *e)
{
    const char *name = recording_column_name(id);
    const double most = recording_column_most(id);
    for (size_t k = 0; k < in->rows; k++) {
        const double x = in->of[id][k];
        if (!isfinite(x)) {
            return error_input(e, in->path, (long)k + 1, 0, "%s is %s; expected a finite number", name,
                               isnan(x) ? "no number" : "infinite");
        }
        if (fabs(x) > most || (x != 0.0 && fabs(x) < RECORDING_LEAST)) {
            return error_input(e, in->path, (long)k + 1, 0,
                               "%s = %g is absurd; expected a number from %g to %g", name, x, -most, most);
        }
        if (id == COL_RUN && x != floor(x)) {
            return error_input(e, in->path, (long)k + 1, 0, "run = %g is not a whole number", x);
        }
    }
    return true;
}

static bool check_time(const source *in, error *e)
{
    const double *t_s = in->of[COL_T];
    const double *run = in->have[COL_RUN] ? in->of[COL_RUN] : NULL;
    for (size_t k = 1; k < in->rows; k++) {
        if ((run == NULL || run[k] == run[k - 1]) && t_s[k] <= t_s[k - 1]) {
            return error_input(e, in->path, (long)k + 1, 0,
                               "t_s = %.9g does not rise: the row before has %.9g in the same run", t_s[k],
                               t_s[k - 1]);
        }
    }
    return true;
}

/* Copies what there is, and fills in the third phase, as the reader does. */
static void fill(recording *r, const source *in)
{
    for (int id = 0; id < COL_COUNT; id++) {
        double **place = recording_column(r, (column_id)id);
        if (place != NULL && in->have[id]) {
            memcpy(*place, in->of[id], in->rows * sizeof **place);
        }
    }
    for (size_t k = 0; k < in->rows; k++) {
        if (in->have[COL_RUN]) {
            r->run[k] = (long)in->of[COL_RUN][k];
        }
        if (!in->have[COL_I_C]) {
            r->i_A[2][k] = -r->i_A[0][k] - r->i_A[1][k];
        }
        if (in->have[COL_MID_A] && !in->have[COL_MID_C]) {
            r->i_mid_A[2][k] = -r->i_mid_A[0][k] - r->i_mid_A[1][k];
        }
    }
    r->rows = in->rows;
    r->path = in->path;
    r->i_c_measured = in->have[COL_I_C];
    r->omega_derived = !in->have[COL_OMEGA];
}

bool recording_make(recording *r, const char *path, size_t rows, size_t count, const char *const *name,
                    const double *const *value, error *e)
{
    source in = {.path = path, .rows = rows};
    bool room[COL_COUNT];
    *r = (recording){0};
    bool ok = take_names(&in, count, name, value, e);
    for (int id = 0; ok && id < COL_COUNT; id++) {
        ok = !in.have[id] || check_column(&in, (column_id)id, e);
    }
    if (!ok || !check_time(&in, e)) {
        return false;
    }
    memcpy(room, in.have, sizeof room);
    room[COL_I_C] = room[COL_OMEGA] = true;
    room[COL_MID_C] = in.have[COL_MID_A];
    if (recording_columns_grow(r, room, rows)) {
        fill(r, &in);
        if (recording_find_stretches(r)) {
            if (r->omega_derived && !speed_from_angle(r, path, e)) {
                recording_free(r);
                return false;
            }
            return true;
        }
    }
    recording_free(r);
    return error_failure(e, 0, "%s: out of memory", path);
}

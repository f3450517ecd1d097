/*
 * From rows on the wire to a recording (record_rows.h).
 */
#include "record_rows.h"

#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

#define COLUMNS 22 /* numbers of the wire, 0 unused */

/* Where each channel of the header stands; -1: not recorded. */
typedef struct channel_map {
    int at[COLUMNS];
} channel_map;

static channel_map map_of(const wire_header *header)
{
    channel_map map;
    for (int k = 0; k < COLUMNS; k++) {
        map.at[k] = -1;
    }
    for (size_t k = 0; k < header->channels; k++) {
        if (header->channel[k].column < COLUMNS) {
            map.at[header->channel[k].column] = (int)k;
        }
    }
    return map;
}

static bool has(const channel_map *map, int column)
{
    return map->at[column] >= 0;
}

/* True with three phases, a vector, or, if `two` suffices, the first two phases. */
static bool has_phases(const channel_map *map, int phase_a, int alpha, bool two)
{
    const bool phases = has(map, phase_a) && has(map, phase_a + 1) && (two || has(map, phase_a + 2));
    return phases || (alpha > 0 && has(map, alpha) && has(map, alpha + 1));
}

static bool check_columns(record_rows *r, const wire_header *header)
{
    const channel_map map = map_of(header);
    for (size_t k = 0; k < header->channels; k++) {
        if (header->channel[k].column == 0 || header->channel[k].column >= COLUMNS) {
            return error_input(&r->e, NULL, 0, 0,
                               "record: channel %zu is of kind %u, which this program does not know", k + 1,
                               (unsigned)header->channel[k].column);
        }
    }
    if (!has_phases(&map, IQFOC_RECORDER_I_A, IQFOC_RECORDER_I_ALPHA, true)) {
        return error_input(&r->e, NULL, 0, 0, "record: the target sends no phase currents");
    }
    if (!has(&map, IQFOC_RECORDER_THETA_E) || !has(&map, IQFOC_RECORDER_OMEGA_E)) {
        return error_input(&r->e, NULL, 0, 0, "record: the target sends no electrical angle or no speed");
    }
    const bool duties = has_phases(&map, IQFOC_RECORDER_D_A, 0, false) && has(&map, IQFOC_RECORDER_U_DC);
    if (!duties && !has_phases(&map, IQFOC_RECORDER_U_A, IQFOC_RECORDER_U_ALPHA, false)) {
        return error_input(&r->e, NULL, 0, 0,
                           "record: the target sends neither voltages nor duties with the DC link");
    }
    return true;
}

/* ---- Columns of the recording; all that are used grow together ---- */

static void columns_of(recording *rec, const channel_map *map, double **column[COLUMNS + 3], size_t *count)
{
    size_t n = 0;
    column[n++] = &rec->t_s;
    column[n++] = &rec->theta_e_rad;
    column[n++] = &rec->omega_e_rad_s;
    for (int x = 0; x < 3; x++) {
        column[n++] = &rec->i_A[x];
        if (has_phases(map, IQFOC_RECORDER_U_A, IQFOC_RECORDER_U_ALPHA, false)) {
            column[n++] = &rec->u_V[x];
        }
        if (has_phases(map, IQFOC_RECORDER_D_A, 0, false)) {
            column[n++] = &rec->duty[x];
        }
        if (has_phases(map, IQFOC_RECORDER_I_MID_A, 0, true)) {
            column[n++] = &rec->i_mid_A[x];
        }
    }
    if (has(map, IQFOC_RECORDER_U_DC)) {
        column[n++] = &rec->u_dc_V;
    }
    if (has(map, IQFOC_RECORDER_THETA_MECH)) {
        column[n++] = &rec->theta_mech_rad;
    }
    if (has(map, IQFOC_RECORDER_TEMP)) {
        column[n++] = &rec->temp_C;
    }
    *count = n;
}

static bool grow(record_rows *r, const channel_map *map)
{
    if (r->recording.rows < r->capacity) {
        return true;
    }
    double **column[COLUMNS + 3];
    size_t count;
    const size_t capacity = r->capacity == 0 ? 4096 : 2 * r->capacity;
    columns_of(&r->recording, map, column, &count);
    for (size_t k = 0; k < count; k++) {
        double *larger = realloc(*column[k], capacity * sizeof **column[k]);
        if (larger == NULL) {
            return error_failure(&r->e, 0, "record: no memory for %zu rows", capacity);
        }
        *column[k] = larger;
    }
    long *run = realloc(r->recording.run, capacity * sizeof *run);
    if (run == NULL) {
        return error_failure(&r->e, 0, "record: no memory for %zu rows", capacity);
    }
    r->recording.run = run;
    r->capacity = capacity;
    return true;
}

/* ---- One row ---- */

typedef struct row_values {
    const wire_header *header;
    const wire_row *row;
    channel_map map;
} row_values;

static double value(const row_values *v, int column)
{
    const int at = v->map.at[column];
    return at < 0 ? 0.0 : v->row->value[at] * v->header->channel[at].scale;
}

/* The phases as recorded, a missing third one as -a - b; or the phases of the vector. */
static void phases(const row_values *v, int phase_a, int alpha, double *const out[3], size_t k)
{
    if (has(&v->map, phase_a)) {
        out[0][k] = value(v, phase_a);
        out[1][k] = value(v, phase_a + 1);
        out[2][k] = has(&v->map, phase_a + 2) ? value(v, phase_a + 2) : -out[0][k] - out[1][k];
        return;
    }
    const vec_ab vector = {value(v, alpha), value(v, alpha + 1)};
    for (int x = 0; x < 3; x++) {
        out[x][k] = vec_phase(vector, x);
    }
}

static void row_put(recording *rec, const row_values *v, size_t k)
{
    rec->t_s[k] = v->row->cycle * v->header->T_s;
    rec->theta_e_rad[k] = value(v, IQFOC_RECORDER_THETA_E);
    rec->omega_e_rad_s[k] = value(v, IQFOC_RECORDER_OMEGA_E);
    phases(v, IQFOC_RECORDER_I_A, IQFOC_RECORDER_I_ALPHA, rec->i_A, k);
    if (rec->u_V[0] != NULL) {
        phases(v, IQFOC_RECORDER_U_A, IQFOC_RECORDER_U_ALPHA, rec->u_V, k);
    }
    if (rec->duty[0] != NULL) {
        phases(v, IQFOC_RECORDER_D_A, 0, rec->duty, k);
    }
    if (rec->i_mid_A[0] != NULL) {
        phases(v, IQFOC_RECORDER_I_MID_A, 0, rec->i_mid_A, k);
    }
    if (rec->u_dc_V != NULL) {
        rec->u_dc_V[k] = value(v, IQFOC_RECORDER_U_DC);
    }
    if (rec->theta_mech_rad != NULL) {
        rec->theta_mech_rad[k] = value(v, IQFOC_RECORDER_THETA_MECH);
    }
    if (rec->temp_C != NULL) {
        rec->temp_C[k] = value(v, IQFOC_RECORDER_TEMP);
    }
}

static bool same_columns(const wire_header *a, const wire_header *b)
{
    bool same = a->channels == b->channels;
    for (size_t k = 0; same && k < a->channels; k++) {
        same = a->channel[k].column == b->channel[k].column;
    }
    return same;
}

bool record_rows_take(void *context, const wire_header *header, const wire_row *row)
{
    record_rows *r = context;
    const row_values v = {header, row, map_of(header)};
    if (!r->begun) {
        if (!check_columns(r, header)) {
            return false;
        }
        r->begun = true;
        r->header = *header;
        r->recording.i_c_measured = has(&v.map, IQFOC_RECORDER_I_C);
    } else if (!same_columns(&r->header, header)) {
        return error_input(&r->e, NULL, 0, 0,
                           "record: the target's channels changed; one recording cannot hold both");
    }
    if (!grow(r, &v.map)) {
        return false;
    }
    r->run += row->after_gap ? 1 : 0;
    const size_t k = r->recording.rows;
    row_put(&r->recording, &v, k);
    r->recording.run[k] = r->run;
    r->recording.rows = k + 1;
    return true;
}

void record_rows_free(record_rows *rows)
{
    recording_free(&rows->recording);
}

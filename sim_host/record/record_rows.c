/* From rows on the wire to a recording (record_rows.h). */
#include "record_rows.h"

#include "base/vector.h"

#include <stdio.h>

#define COLUMNS 23 /* numbers of the wire, 0 unused; the status bits are for a scope, no recording has them */

/* Place of each channel in the header; -1: not recorded. */
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

/* Where three columns of a recording come from. */
static const struct group {
    column_id first;
    int phase_a, alpha; /* alpha: 0 if the wire has no vector for it */
    bool two;           /* two phases suffice */
} groups[] = {
    {COL_I_A, IQFOC_RECORDER_I_A, IQFOC_RECORDER_I_ALPHA, true},
    {COL_U_A, IQFOC_RECORDER_U_A, IQFOC_RECORDER_U_ALPHA, false},
    {COL_D_A, IQFOC_RECORDER_D_A, 0, false},
    {COL_MID_A, IQFOC_RECORDER_I_MID_A, 0, true},
};

static const struct single {
    column_id id;
    int column;
} singles[] = {
    {COL_THETA, IQFOC_RECORDER_THETA_E}, {COL_OMEGA, IQFOC_RECORDER_OMEGA_E},
    {COL_U_DC, IQFOC_RECORDER_U_DC},     {COL_THETA_MECH, IQFOC_RECORDER_THETA_MECH},
    {COL_TEMP, IQFOC_RECORDER_TEMP},
};

enum { GROUPS = sizeof groups / sizeof groups[0], SINGLES = sizeof singles / sizeof singles[0] };

static void find_columns(record_rows *r, const channel_map *map)
{
    r->have[COL_RUN] = r->have[COL_T] = true;
    for (int n = 0; n < GROUPS; n++) {
        const struct group *g = &groups[n];
        const bool there = has_phases(map, g->phase_a, g->alpha, g->two);
        r->have[g->first] = r->have[g->first + 1] = r->have[g->first + 2] = there;
    }
    for (int n = 0; n < SINGLES; n++) {
        r->have[singles[n].id] = has(map, singles[n].column);
    }
}

static bool check_columns(record_rows *r, const wire_header *header)
{
    const channel_map map = map_of(header);
    const bool *have = r->have;
    find_columns(r, &map);
    for (size_t k = 0; k < header->channels; k++) {
        if (header->channel[k].column == 0 || header->channel[k].column >= COLUMNS) {
            return error_input(&r->e, NULL, 0, 0,
                               "record: channel %zu is of kind %u, which this program does not know", k + 1,
                               (unsigned)header->channel[k].column);
        }
    }
    if (!have[COL_I_A]) {
        return error_input(&r->e, NULL, 0, 0, "record: the target sends no phase currents");
    }
    if (!have[COL_THETA] || !have[COL_OMEGA]) {
        return error_input(&r->e, NULL, 0, 0, "record: the target sends no electrical angle or no speed");
    }
    if (!have[COL_U_A] && !(have[COL_D_A] && have[COL_U_DC])) {
        return error_input(&r->e, NULL, 0, 0,
                           "record: the target sends neither voltages nor duties with the DC link");
    }
    return true;
}

static bool grow(record_rows *r)
{
    if (r->recording.rows < r->capacity) {
        return true;
    }
    const size_t capacity = r->capacity == 0 ? 4096 : 2 * r->capacity;
    if (!recording_columns_grow(&r->recording, r->have, capacity)) {
        return error_failure(&r->e, 0, "record: out of memory for %zu rows", capacity);
    }
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
static void phases(const row_values *v, int phase_a, int alpha, double out[3])
{
    if (has(&v->map, phase_a)) {
        out[0] = value(v, phase_a);
        out[1] = value(v, phase_a + 1);
        out[2] = has(&v->map, phase_a + 2) ? value(v, phase_a + 2) : -out[0] - out[1];
        return;
    }
    const vec_ab vector = {value(v, alpha), value(v, alpha + 1)};
    vec_to_phases(vector, out);
}

static void row_put(record_rows *r, const row_values *v)
{
    recording *rec = &r->recording;
    const size_t k = rec->rows++;
    rec->run[k] = r->run;
    rec->t_s[k] = v->row->cycle * v->header->T_s;
    for (int n = 0; n < GROUPS; n++) {
        double abc[3];
        phases(v, groups[n].phase_a, groups[n].alpha, abc);
        for (int x = 0; x < 3 && r->have[groups[n].first]; x++) {
            (*recording_column(rec, (column_id)((int)groups[n].first + x)))[k] = abc[x];
        }
    }
    for (int n = 0; n < SINGLES; n++) {
        if (r->have[singles[n].id]) {
            (*recording_column(rec, singles[n].id))[k] = value(v, singles[n].column);
        }
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
    } else if (r->header.decimation != header->decimation) {
        return error_input(&r->e, NULL, 0, 0,
                           "record: a row every %u cycles, then every %u; one recording cannot hold both",
                           (unsigned)r->header.decimation, (unsigned)header->decimation);
    }
    if (!grow(r)) {
        return false;
    }
    r->run += row->after_gap ? 1 : 0;
    row_put(r, &v);
    return true;
}

void record_rows_free(record_rows *rows)
{
    recording_free(&rows->recording);
}

void record_comment(const wire_counts *c, char *text, size_t size)
{
    (void)snprintf(
        text, size,
        "iqfoc record: %lu frames, %lu damaged, %lu lost, %lu rows lost on the target, %lu missing in all",
        c->frames, c->damaged, c->lost_frames, c->lost_rows, c->missing_rows);
}

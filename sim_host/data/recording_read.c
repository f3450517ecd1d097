/*
 * The reader: records of fields from csv_file, numbers from number_parse, into columns.
 */
#include "recording.h"

#include "../base/number.h"
#include "csv_file.h"
#include "recording_columns.h"
#include "recording_missing.h"
#include "speed_from_angle.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIELDS_MAX = 1024,           /* columns in a file; a line of text taken for a header ends here */
    ROWS_MAX = 16 * 1024 * 1024, /* an hour at 4.6 kHz; what unpacks to more is not to fill memory */
    RUNS_MAX = 100000            /* an operating point is many cycles */
};

typedef struct reader {
    recording *r;
    csv_file csv;
    bool has_header;
    size_t fields;                /* of the header */
    column_id target[FIELDS_MAX]; /* what each field of the file is; COL_COUNT: ignored */
    size_t field_of[COL_COUNT];   /* and back */
    bool have[COL_COUNT];
    recording_missing missing;
    size_t rows_allocated;
    long runs; /* changes of the run so far */
} reader;

static bool out_of_memory(reader *in)
{
    return error_failure(in->csv.e, 0, "%s: out of memory", in->csv.lines.path);
}

/* ---- header ---- */

static void header_field(reader *in, size_t index, const char *text, size_t length)
{
    if (index >= FIELDS_MAX) {
        csv_file_refuse(&in->csv, index, "more than %d columns; expected a recording", FIELDS_MAX);
        return;
    }
    const column_id id = recording_column_find(text, length);
    in->target[index] = id;
    if (id == COL_COUNT) {
        recording_missing_note(&in->missing, text, length);
        return;
    }
    if (in->have[id]) {
        csv_file_refuse(&in->csv, index, "column %s is twice in the header; remove one",
                        recording_column_name(id));
        return;
    }
    in->have[id] = true;
    in->field_of[id] = index;
}

/* Which columns will be read, and whether they suffice. */
static void header_end(reader *in, size_t fields)
{
    in->fields = fields;
    in->has_header = true;
    recording_missing_find(&in->missing, in->have);
    if (in->missing.list[0] != '\0') {
        recording_missing_refuse(&in->missing, &in->csv);
        return;
    }
    recording_columns_whole(in->have);
    for (size_t index = 0; index < fields; index++) {
        if (in->target[index] != COL_COUNT && !in->have[in->target[index]]) {
            in->target[index] = COL_COUNT;
        }
    }
}

/* ---- rows ---- */

static bool grow_doubles(double **column, size_t rows)
{
    double *grown = realloc(*column, rows * sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    *column = grown;
    return true;
}

static bool grow_longs(long **column, size_t rows)
{
    long *grown = realloc(*column, rows * sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    *column = grown;
    return true;
}

/* Makes room for twice as many rows in each column that is read. */
static bool grow(reader *in)
{
    recording *r = in->r;
    if (in->rows_allocated >= ROWS_MAX) {
        csv_file_refuse(&in->csv, 0, "more than %d rows; expected a recording of minutes", ROWS_MAX);
        return false;
    }
    const size_t rows = in->rows_allocated == 0 ? 4096 : 2 * in->rows_allocated;
    bool ok = grow_longs(&r->line, rows) && (!in->have[COL_RUN] || grow_longs(&r->run, rows));
    for (int id = 0; ok && id < COL_COUNT; id++) {
        /* The third phase and the speed have a column even if the file has none. */
        const bool filled_in = id == COL_I_C || id == COL_OMEGA || (id == COL_MID_C && in->have[COL_MID_A]);
        if (id != COL_RUN && (in->have[id] || filled_in)) {
            ok = grow_doubles(recording_column(r, (column_id)id), rows);
        }
    }
    if (ok) {
        in->rows_allocated = rows;
        return true;
    }
    return out_of_memory(in);
}

/* Quotes the field in a message, cut to a length that fits a line. */
static void refuse_number(reader *in, size_t index, const char *text, size_t length, const char *complaint)
{
    const char *name = recording_column_name(in->target[index]);
    if (length == strlen(name) && memcmp(text, name, length) == 0) {
        csv_file_refuse(&in->csv, index, "the header is repeated here; a recording has one header");
    } else if (length == 0) {
        csv_file_refuse(&in->csv, index, "%s is empty; expected a number", name);
    } else {
        csv_file_refuse(&in->csv, index, "%s \"%.*s%s\" %s; expected a finite decimal number", name,
                        length > 40 ? 40 : (int)length, text, length > 40 ? "..." : "", complaint);
    }
}

/* What no drive has is a number read wrongly, and would overflow in what is made of it. */
static void check_size(reader *in, column_id id, size_t index, const char *text, size_t length, double value)
{
    const double most = recording_column_most(id);
    const int shown = length > 40 ? 40 : (int)length;
    if (fabs(value) > most) {
        csv_file_refuse(&in->csv, index, "%s \"%.*s\" is absurd; expected a number from %g to %g",
                        recording_column_name(id), shown, text, -most, most);
    } else if (value != 0.0 && fabs(value) < RECORDING_LEAST) {
        csv_file_refuse(&in->csv, index, "%s \"%.*s\" is absurd; expected 0 or a number of %g at least",
                        recording_column_name(id), shown, text, RECORDING_LEAST);
    }
}

static void row_field(reader *in, size_t index, const char *text, size_t length)
{
    if (index >= in->fields) {
        return; /* row_end says so, once it knows how many there are */
    }
    const column_id id = in->target[index];
    if (id == COL_COUNT) {
        return;
    }
    if (in->r->rows == in->rows_allocated && !grow(in)) {
        return;
    }
    double value = 0.0;
    const number_result result = number_parse(text, length, &value);
    if (result != NUMBER_OK) {
        refuse_number(in, index, text, length, number_complaint(result));
    } else if (id != COL_RUN) {
        (*recording_column(in->r, id))[in->r->rows] = value;
        check_size(in, id, index, text, length, value);
    } else if (value != floor(value) || fabs(value) > INT_MAX) {
        refuse_number(in, index, text, length, "is not a whole number that fits 32 bits");
    } else {
        in->r->run[in->r->rows] = (long)value;
    }
}

static void row_end(reader *in, size_t fields)
{
    recording *r = in->r;
    if (fields < in->fields) {
        csv_file_refuse(&in->csv, 0, "the row has %zu field%s, the header has %zu; is the file cut off?",
                        fields, fields == 1 ? "" : "s", in->fields);
        return;
    }
    if (fields > in->fields) {
        csv_file_refuse(&in->csv, in->fields, "the row has %zu fields, the header has %zu", fields,
                        in->fields);
        return;
    }
    const size_t k = r->rows;
    r->line[k] = in->csv.record_line;
    if (!in->have[COL_I_C]) {
        r->i_A[2][k] = -r->i_A[0][k] - r->i_A[1][k];
    }
    if (r->i_mid_A[2] != NULL && !in->have[COL_MID_C]) {
        r->i_mid_A[2][k] = -r->i_mid_A[0][k] - r->i_mid_A[1][k];
    }
    const bool same_run = k > 0 && (r->run == NULL || r->run[k] == r->run[k - 1]);
    in->runs += same_run ? 0 : 1;
    if (in->runs > RUNS_MAX) {
        csv_file_refuse(&in->csv, in->field_of[COL_RUN], "more than %d runs; expected many rows in each",
                        RUNS_MAX);
        return;
    }
    if (same_run && r->t_s[k] <= r->t_s[k - 1]) {
        csv_file_refuse(
            &in->csv, in->field_of[COL_T],
            "t_s = %.9g does not rise: the row before has %.9g in the same run%s", r->t_s[k], r->t_s[k - 1],
            r->t_s[k] == r->t_s[k - 1] ? " (stamps of too few decimals? Each cycle needs its own)" : "");
        return;
    }
    r->rows++;
}

/* ---- the whole ---- */

static void on_field(void *context, size_t index, const char *text, size_t length)
{
    reader *in = context;
    if (in->has_header) {
        row_field(in, index, text, length);
    } else {
        header_field(in, index, text, length);
    }
}

static void on_record(void *context, size_t fields)
{
    reader *in = context;
    if (in->has_header) {
        row_end(in, fields);
    } else {
        header_end(in, fields);
    }
}

static bool has_rows(reader *in)
{
    const line_source *lines = &in->csv.lines;
    if (!in->has_header) {
        return error_input(in->csv.e, lines->path, lines->number > 0 ? lines->number : 1, 1,
                           "the file is empty; expected a header row of column names");
    }
    if (in->r->rows == 0) {
        return error_input(in->csv.e, lines->path, lines->number + 1, 1,
                           "the file ends after its header; expected rows");
    }
    return true;
}

/* Frees the room beyond the last row that the doubling left. */
static void trim(recording *r)
{
    for (int id = 0; id < COL_COUNT; id++) {
        double **column = recording_column(r, (column_id)id);
        if (column != NULL && *column != NULL) {
            grow_doubles(column, r->rows);
        }
    }
    grow_longs(&r->line, r->rows);
    if (r->run != NULL) {
        grow_longs(&r->run, r->rows);
    }
}

static void on_comment(void *context, const char *text, size_t length, long number)
{
    reader *in = context;
    bool taken = false;
    if (!pwm_updates_take_comment(&in->r->pwm, text, length, &taken)) {
        error_input(
            in->csv.e, in->csv.lines.path, number, 0,
            "expected # [pwm] periods_per_cycle = 1 to %d, held = \"stator\" or \"rotor\", "
            "delay_cycles = 0 to 1; or # "
            "[sensors] shunts = \"three\" or \"two_lowest\"; or # [control] modulation = \"pattern\", "
            "pulses = an odd number from %d to %d",
            PWM_UPDATES_MOST, PATTERN_PULSES_LEAST, PATTERN_PULSES_MOST);
    }
    in->r->pwm_stated = in->r->pwm_stated || taken;
}

bool recording_read(const char *path, recording *r, error *e)
{
    *r = (recording){0};
    reader *in = calloc(1, sizeof *in);
    if (in == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    in->r = r;
    in->csv = (csv_file){
        .on_field = on_field, .on_record = on_record, .on_comment = on_comment, .context = in, .e = e};
    bool ok = csv_file_read(&in->csv, path) && has_rows(in);
    if (ok) {
        r->i_c_measured = in->have[COL_I_C];
        trim(r);
        ok = recording_find_stretches(r) || out_of_memory(in);
        r->omega_derived = !in->have[COL_OMEGA];
        ok = ok && (!r->omega_derived || speed_from_angle(r, path, e));
    }
    csv_file_free(&in->csv);
    free(in);
    if (!ok) {
        recording_free(r);
    } else {
        r->path = path;
    }
    return ok;
}

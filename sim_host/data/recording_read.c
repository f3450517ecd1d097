/*
 * The reader: lines from line_source, fields from libcsv, numbers from number_parse.
 *
 * libcsv is fed line by line, so that the line of every field is known; the column of a field is looked for
 * only when there is something to complain about.
 */
#include "recording.h"

#include "../base/number.h"
#include "line_source.h"
#include "recording_columns.h"

#include <csv.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIELDS_MAX = 1024 /* columns in a file; a line of text taken for a header ends here */
};

typedef struct reader {
    recording *r;
    error *e;
    line_source lines;
    char *record; /* the record being parsed, from its first line on: a quoted field may hold line breaks */
    size_t record_length, record_size;
    long record_line;
    bool has_header;
    size_t field;                 /* index of the next field in this record */
    size_t fields;                /* of the header */
    column_id target[FIELDS_MAX]; /* what each field of the file is; COL_COUNT: ignored */
    size_t field_of[COL_COUNT];   /* and back */
    bool have[COL_COUNT];
    size_t rows_allocated;
} reader;

static bool out_of_memory(reader *in)
{
    return error_failure(in->e, 0, "%s: out of memory", in->lines.path);
}

/* ---- where a field stands ---- */

/*
 * Line and character column (from 1) of the start of field `index` of the current record. Columns count
 * characters, not bytes: a UTF-8 continuation byte counts nothing.
 */
static void field_position(const reader *in, size_t index, long *line, long *column)
{
    bool quoted = false;
    *line = in->record_line;
    *column = 1;
    for (size_t at = 0; at < in->record_length && index > 0; at++) {
        const unsigned char c = (unsigned char)in->record[at];
        if (c == '"') {
            quoted = !quoted; /* a doubled quote toggles twice */
        } else if (c == ',' && !quoted) {
            index--;
        }
        if (c == '\n') {
            *line += 1;
            *column = 1;
        } else if ((c & 0xC0) != 0x80) {
            *column += 1;
        }
    }
}

static void refuse_field(reader *in, size_t index, const char *text)
{
    long line;
    long column;
    field_position(in, index, &line, &column);
    error_input(in->e, in->lines.path, line, column, "%s", text);
}

/* ---- header ---- */

static void header_field(reader *in, const char *text, size_t length)
{
    if (in->field >= FIELDS_MAX) {
        refuse_field(in, in->field, "more than 1024 columns; expected a recording");
        return;
    }
    const column_id id = recording_column_find(text, length);
    in->target[in->field] = id;
    if (id == COL_COUNT) {
        return;
    }
    if (in->have[id]) {
        char message[128];
        snprintf(message, sizeof message, "column %s stands twice in the header", recording_column_name(id));
        refuse_field(in, in->field, message);
        return;
    }
    in->have[id] = true;
    in->field_of[id] = in->field;
}

static bool have_three(const reader *in, column_id first)
{
    return in->have[first] && in->have[first + 1] && in->have[first + 2];
}

static void drop_three(reader *in, column_id first)
{
    for (int i = 0; i < 3; i++) {
        const column_id id = (column_id)((int)first + i);
        if (in->have[id]) {
            in->have[id] = false;
            in->target[in->field_of[id]] = COL_COUNT;
        }
    }
}

static void refuse_missing(reader *in, const char *what)
{
    size_t length = 0; /* of the header's text, the longest part of it that still fits a message */
    while (length < in->record_length && length < 300 && in->record[length] != '\r' &&
           in->record[length] != '\n') {
        length++;
    }
    error_input(in->e, in->lines.path, in->record_line, 1, "%s is missing; found %.*s", what, (int)length,
                in->record);
}

/* Which columns will be read, and whether they suffice. */
static void header_end(reader *in)
{
    static const column_id required[] = {COL_T, COL_I_A, COL_I_B, COL_THETA, COL_OMEGA};

    in->fields = in->field;
    in->has_header = true;
    for (size_t i = 0; i < sizeof required / sizeof required[0]; i++) {
        if (!in->have[required[i]]) {
            char what[64];
            snprintf(what, sizeof what, "column %s", recording_column_name(required[i]));
            refuse_missing(in, what);
            return;
        }
    }
    const bool has_u = have_three(in, COL_U_A);
    const bool has_duty = have_three(in, COL_D_A);
    if (!has_u && has_duty && !in->have[COL_U_DC]) {
        refuse_missing(in, "column u_dc_V, which the duties need,");
        return;
    }
    if (!has_u && !has_duty) {
        refuse_missing(in, "the voltage: columns u_a_V, u_b_V and u_c_V, or d_a, d_b, d_c and u_dc_V,");
        return;
    }
    /* Half a group is of no use beside a whole one. */
    if (!has_u) {
        drop_three(in, COL_U_A);
    }
    if (!has_duty || !in->have[COL_U_DC]) {
        drop_three(in, COL_D_A);
    }
    if (!in->have[COL_MID_A] || !in->have[COL_MID_B]) {
        drop_three(in, COL_MID_A);
    }
}

/* ---- rows ---- */

static bool grow(reader *in)
{
    recording *r = in->r;
    const size_t rows = in->rows_allocated == 0 ? 4096 : 2 * in->rows_allocated;
    for (int id = 0; id < COL_COUNT; id++) {
        /* The third phase has a column even if the file has none. */
        const bool filled_in = id == COL_I_C || (id == COL_MID_C && in->have[COL_MID_A]);
        if (id == COL_RUN || (!in->have[id] && !filled_in)) {
            continue;
        }
        double **column = recording_column(r, (column_id)id);
        double *grown = realloc(*column, rows * sizeof *grown);
        if (grown == NULL) {
            return out_of_memory(in);
        }
        *column = grown;
    }
    long **integers[2] = {&r->line, in->have[COL_RUN] ? &r->run : NULL};
    for (int i = 0; i < 2 && integers[i] != NULL; i++) {
        long *grown = realloc(*integers[i], rows * sizeof *grown);
        if (grown == NULL) {
            return out_of_memory(in);
        }
        *integers[i] = grown;
    }
    in->rows_allocated = rows;
    return true;
}

/* Quotes what stands there, cut to a length that fits a line. */
static void refuse_number(reader *in, column_id id, const char *text, size_t length, const char *complaint)
{
    const char *name = recording_column_name(id);
    char message[256];
    if (length == strlen(name) && memcmp(text, name, length) == 0) {
        snprintf(message, sizeof message, "the header stands here again; a recording has one header");
    } else if (length == 0) {
        snprintf(message, sizeof message, "%s is empty; expected a number", name);
    } else {
        snprintf(message, sizeof message, "%s \"%.*s%s\" %s; expected a finite decimal number", name,
                 length > 40 ? 40 : (int)length, text, length > 40 ? "..." : "", complaint);
    }
    refuse_field(in, in->field, message);
}

static void row_field(reader *in, const char *text, size_t length)
{
    if (in->field >= in->fields) {
        return; /* row_end says so, once it knows how many there are */
    }
    const column_id id = in->target[in->field];
    if (id == COL_COUNT) {
        return;
    }
    if (in->r->rows == in->rows_allocated && !grow(in)) {
        return;
    }
    double value = 0.0;
    const number_result result = number_parse(text, length, &value);
    if (result != NUMBER_OK) {
        refuse_number(in, id, text, length, number_complaint(result));
    } else if (id != COL_RUN) {
        (*recording_column(in->r, id))[in->r->rows] = value;
    } else if (value != floor(value) || fabs(value) > INT_MAX) {
        refuse_number(in, id, text, length, "is not a whole number that fits 32 bits");
    } else {
        in->r->run[in->r->rows] = (long)value;
    }
}

static bool is_same_run(const recording *r, size_t k)
{
    return r->run == NULL || r->run[k] == r->run[k - 1];
}

static void row_end(reader *in)
{
    recording *r = in->r;
    if (in->field != in->fields) {
        char message[128];
        snprintf(message, sizeof message, "the row has %zu field%s, the header has %zu%s", in->field,
                 in->field == 1 ? "" : "s", in->fields,
                 in->field < in->fields ? "; is the file cut off?" : "");
        refuse_field(in, in->field < in->fields ? 0 : in->fields, message);
        return;
    }
    const size_t k = r->rows;
    r->line[k] = in->record_line;
    if (!in->have[COL_I_C]) {
        r->i_A[2][k] = -r->i_A[0][k] - r->i_A[1][k];
    }
    if (r->i_mid_A[2] != NULL && !in->have[COL_MID_C]) {
        r->i_mid_A[2][k] = -r->i_mid_A[0][k] - r->i_mid_A[1][k];
    }
    if (k > 0 && is_same_run(r, k) && r->t_s[k] <= r->t_s[k - 1]) {
        char message[160];
        snprintf(message, sizeof message, "t_s = %.9g does not rise: the row before has %.9g in the same run",
                 r->t_s[k], r->t_s[k - 1]);
        refuse_field(in, in->field_of[COL_T], message);
        return;
    }
    r->rows++;
}

/* ---- libcsv's callbacks ---- */

static void on_field(void *text, size_t length, void *context)
{
    reader *in = context;
    if (in->e->status != STATUS_DONE) {
        return; /* libcsv cannot be stopped within a line */
    }
    if (in->has_header) {
        row_field(in, text, length);
    } else {
        header_field(in, text, length);
    }
    in->field++;
}

static void on_record(int terminator, void *context)
{
    (void)terminator;
    reader *in = context;
    if (in->e->status == STATUS_DONE) {
        if (in->has_header) {
            row_end(in);
        } else {
            header_end(in);
        }
    }
    in->field = 0;
    in->record_length = 0;
}

/* ---- lines ---- */

static bool record_append(reader *in)
{
    const size_t need = in->record_length + in->lines.length;
    if (need > in->record_size) {
        char *grown = realloc(in->record, 2 * need);
        if (grown == NULL) {
            return out_of_memory(in);
        }
        in->record = grown;
        in->record_size = 2 * need;
    }
    if (in->record_length == 0) {
        in->record_line = in->lines.number;
    }
    memcpy(in->record + in->record_length, in->lines.line, in->lines.length);
    in->record_length = need;
    return true;
}

/* Comments, blank lines and a byte order mark may stand ahead of the header. */
static bool is_ahead_of_header(reader *in)
{
    if (in->has_header || in->record_length > 0) {
        return false;
    }
    if (in->lines.number == 1 && in->lines.length >= 3 && memcmp(in->lines.line, "\xEF\xBB\xBF", 3) == 0) {
        in->lines.line += 3;
        in->lines.length -= 3;
    }
    return in->lines.length == 0 || in->lines.line[0] == '#' || in->lines.line[0] == '\n' ||
           in->lines.line[0] == '\r';
}

static void feed_lines(reader *in, struct csv_parser *csv)
{
    while (line_source_next(&in->lines, in->e)) {
        if (is_ahead_of_header(in)) {
            continue;
        }
        if (!record_append(in)) {
            return;
        }
        if (csv_parse(csv, in->lines.line, in->lines.length, on_field, on_record, in) != in->lines.length) {
            if (csv_error(csv) == CSV_EPARSE) {
                refuse_field(in, in->field,
                             "a quote stands within a field or after its end; expected RFC 4180");
            } else {
                out_of_memory(in);
            }
        }
        if (in->e->status != STATUS_DONE) {
            return;
        }
    }
    if (in->e->status == STATUS_DONE && csv_fini(csv, on_field, on_record, in) != 0) {
        refuse_field(in, in->field, "a quoted field has no end; is the file cut off?");
    }
}

static void refuse_without_rows(reader *in)
{
    if (!in->has_header) {
        error_input(in->e, in->lines.path, in->lines.number > 0 ? in->lines.number : 1, 1,
                    "the file is empty; expected a header row of column names");
    } else if (in->r->rows == 0) {
        error_input(in->e, in->lines.path, in->lines.number + 1, 1,
                    "the file ends after its header; expected rows");
    }
}

/* Gives back what doubling took too much. */
static void trim(recording *r)
{
    for (int id = 0; id < COL_COUNT; id++) {
        double **column = recording_column(r, (column_id)id);
        double *trimmed =
            column != NULL && *column != NULL ? realloc(*column, r->rows * sizeof **column) : NULL;
        if (trimmed != NULL) {
            *column = trimmed;
        }
    }
}

bool recording_read(const char *path, recording *r, error *e)
{
    *r = (recording){0};
    reader *in = calloc(1, sizeof *in);
    if (in == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    in->r = r;
    in->e = e;
    struct csv_parser csv;
    if (line_source_open(&in->lines, path, e)) {
        if (csv_init(&csv, CSV_STRICT | CSV_STRICT_FINI) == 0) {
            feed_lines(in, &csv);
            csv_free(&csv);
        } else {
            out_of_memory(in);
        }
        refuse_without_rows(in);
    }
    r->i_c_measured = in->have[COL_I_C];
    if (e->status == STATUS_DONE) {
        trim(r);
        if (!recording_find_stretches(r)) {
            out_of_memory(in);
        }
    }
    line_source_close(&in->lines);
    free(in->record);
    free(in);
    if (e->status != STATUS_DONE) {
        recording_free(r);
        return false;
    }
    return true;
}

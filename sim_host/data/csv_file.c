/* Records and fields by libcsv, fed line by line (csv_file.h). */
#include "csv_file.h"

#include <csv.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/*
 * Line and character column (from 1) of the start of field `index` of the present record. Columns count
 * characters, not bytes: a UTF-8 continuation byte counts nothing.
 */
static void field_position(const csv_file *f, size_t index, long *line, long *column)
{
    bool quoted = false;
    *line = f->record_line;
    *column = 1;
    for (size_t at = 0; at < f->record_length && index > 0; at++) {
        const unsigned char c = (unsigned char)f->record[at];
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

void csv_file_refuse(csv_file *f, size_t index, const char *format, ...)
{
    long line;
    long column;
    field_position(f, index, &line, &column);
    va_list args;
    va_start(args, format);
    error_input_args(f->e, f->lines.path, line, column, format, args);
    va_end(args);
}

static bool is_stopped(const csv_file *f)
{
    return f->e->status != STATUS_DONE;
}

/* ---- libcsv's callbacks; libcsv cannot be stopped within a line ---- */

static void field_end(void *text, size_t length, void *context)
{
    csv_file *f = context;
    if (!is_stopped(f)) {
        f->on_field(f->context, f->field, text, length);
    }
    f->field++;
}

static void record_end(int terminator, void *context)
{
    (void)terminator;
    csv_file *f = context;
    if (!is_stopped(f)) {
        f->on_record(f->context, f->field);
    }
    f->started = true;
    f->field = 0;
    f->record_length = 0;
}

/* ---- lines ---- */

static bool out_of_memory(csv_file *f)
{
    return error_failure(f->e, 0, "%s: out of memory", f->lines.path);
}

static bool record_append(csv_file *f)
{
    const size_t need = f->record_length + f->lines.length;
    if (need > f->record_size) {
        char *grown = realloc(f->record, 2 * need);
        if (grown == NULL) {
            return out_of_memory(f);
        }
        f->record = grown;
        f->record_size = 2 * need;
    }
    if (f->record_length == 0) {
        f->record_line = f->lines.number;
    }
    memcpy(f->record + f->record_length, f->lines.line, f->lines.length);
    f->record_length = need;
    return true;
}

/* Comments, blank lines and a byte order mark may stand ahead of the first record. */
static bool is_ahead(csv_file *f)
{
    line_source *lines = &f->lines;
    if (f->started || f->record_length > 0) {
        return false;
    }
    if (lines->number == 1 && lines->length >= 3 && memcmp(lines->line, "\xEF\xBB\xBF", 3) == 0) {
        lines->line += 3;
        lines->length -= 3;
    }
    const char first = lines->length > 0 ? lines->line[0] : '\n';
    return first == '#' || first == '\r' || first == '\n';
}

static void feed_line(csv_file *f, struct csv_parser *csv)
{
    if (is_ahead(f) || !record_append(f)) {
        return;
    }
    const line_source *lines = &f->lines;
    if (csv_parse(csv, lines->line, lines->length, field_end, record_end, f) == lines->length) {
        return;
    }
    if (csv_error(csv) == CSV_EPARSE) {
        csv_file_refuse(f, f->field,
                        "a quote stands within a field or text after its end; expected RFC 4180");
    } else {
        out_of_memory(f);
    }
}

bool csv_file_read(csv_file *f, const char *path)
{
    struct csv_parser csv;
    if (!line_source_open(&f->lines, path, f->e)) {
        return false;
    }
    if (csv_init(&csv, CSV_STRICT | CSV_STRICT_FINI) != 0) {
        return out_of_memory(f);
    }
    while (!is_stopped(f) && line_source_next(&f->lines, f->e)) {
        feed_line(f, &csv);
    }
    if (!is_stopped(f) && csv_fini(&csv, field_end, record_end, f) != 0) {
        csv_file_refuse(f, f->field, "a quoted field has no end; is the file cut off?");
    }
    csv_free(&csv);
    return !is_stopped(f);
}

void csv_file_free(csv_file *f)
{
    line_source_close(&f->lines);
    free(f->record);
    f->record = NULL;
    f->record_length = f->record_size = 0;
}

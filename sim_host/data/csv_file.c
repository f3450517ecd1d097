/* Records and fields: plain lines at their commas, the others as quoted ones (csv_file.h). */
#include "csv_file.h"

#include "csv_quoted.h"

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
    for (size_t offset = 0; offset < f->text_length && index > 0; offset++) {
        const unsigned char c = (unsigned char)f->text[offset];
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

static void give_field(csv_file *f, const char *text, size_t length)
{
    if (!is_stopped(f)) {
        f->on_field(f->context, f->field, text, length);
    }
    f->field++;
}

static void give_record(csv_file *f)
{
    if (!is_stopped(f)) {
        f->on_record(f->context, f->field);
    }
    f->started = true;
    f->last_line = f->lines.number;
    f->field = 0;
    f->record_length = 0;
}

/* ---- what csv_quoted finds; it is not stopped within a line ---- */

static void quoted_field(void *context, const char *text, size_t length)
{
    give_field(context, text, length);
}

static void quoted_record(void *context)
{
    give_record(context);
}

/* ---- lines ---- */

static bool out_of_memory(csv_file *f)
{
    return error_failure(f->e, 0, "%s: out of memory", f->lines.path);
}

static bool record_append(csv_file *f)
{
    const size_t need = f->record_length + f->lines.length;
    if (need > LINE_SOURCE_LONGEST) {
        return error_input(
            f->e, f->lines.path, f->record_line, 0,
            "a quoted field over several lines makes the row longer than 1 MiB; expected a CSV file");
    }
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
    f->text = f->record;
    f->text_length = need;
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
    if (first == '#' && f->on_comment != NULL && !is_stopped(f)) {
        f->on_comment(f->context, lines->line, lines->length, lines->number);
    }
    return first == '#' || first == '\r' || first == '\n';
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t';
}

/* The length of a line without its line end. */
static size_t line_length(const line_source *lines)
{
    size_t length = lines->length;
    if (length > 0 && lines->line[length - 1] == '\n') {
        length--;
    }
    return length > 0 && lines->line[length - 1] == '\r' ? length - 1 : length;
}

/* Whether the line is a complete record as it is: nothing quoted, and no line end within it. */
static bool is_plain(const csv_file *f, size_t length)
{
    const char *line = f->lines.line;
    return f->record_length == 0 && memchr(line, '"', length) == NULL && memchr(line, '\r', length) == NULL;
}

/* The fields of a plain line: the text between its commas, without the spaces around it. */
static void part_line(csv_file *f, size_t length)
{
    const char *offset = f->lines.line;
    const char *const end = offset + length;
    f->text = offset;
    f->text_length = length;
    f->record_line = f->lines.number;
    while (!is_stopped(f)) {
        const char *comma = memchr(offset, ',', (size_t)(end - offset));
        const char *last = comma != NULL ? comma : end;
        while (offset < last && is_space(*offset)) {
            offset++;
        }
        while (last > offset && is_space(last[-1])) {
            last--;
        }
        give_field(f, offset, (size_t)(last - offset));
        if (comma == NULL) {
            give_record(f);
            return;
        }
        offset = comma + 1;
    }
}

static bool is_blank(const char *line, size_t length)
{
    for (size_t k = 0; k < length; k++) {
        if (!is_space(line[k])) {
            return false;
        }
    }
    return true;
}

/* A small packed file may unpack to blank lines without an end. */
static void count_without_record(csv_file *f)
{
    if (f->lines.number - f->last_line > CSV_FILE_LINES_WITHOUT_RECORD) {
        error_input(f->e, f->lines.path, f->lines.number, 0,
                    "more than a million lines without a row; expected a CSV file");
    }
}

static void feed_line(csv_file *f, csv_quoted *quoted)
{
    count_without_record(f);
    if (is_ahead(f)) {
        return;
    }
    const size_t length = line_length(&f->lines);
    if (quoted->state == CSV_BEFORE_RECORD && is_plain(f, length)) {
        if (!is_blank(f->lines.line, length)) {
            part_line(f, length);
        }
        return;
    }
    if (!record_append(f)) {
        return;
    }
    switch (csv_quoted_feed(quoted, f->lines.line, f->lines.length)) {
    case CSV_QUOTED_OK:
        break;
    case CSV_QUOTED_STRAY:
        csv_file_refuse(f, f->field,
                        "a quote inside an unquoted field, or text after a closing quote; expected RFC 4180");
        break;
    case CSV_QUOTED_NO_MEMORY:
        out_of_memory(f);
        break;
    }
}

bool csv_file_read(csv_file *f, const char *path)
{
    csv_quoted quoted = {.on_field = quoted_field, .on_record = quoted_record, .context = f};
    if (!line_source_open(&f->lines, path, f->e)) {
        return false;
    }
    while (!is_stopped(f) && line_source_next(&f->lines, f->e)) {
        feed_line(f, &quoted);
    }
    if (!is_stopped(f) && !csv_quoted_end(&quoted)) {
        csv_file_refuse(f, f->field, "a quoted field has no end; is the file cut off?");
    }
    csv_quoted_free(&quoted);
    return !is_stopped(f);
}

void csv_file_free(csv_file *f)
{
    line_source_close(&f->lines);
    free(f->record);
    f->record = NULL;
    f->record_length = f->record_size = 0;
}

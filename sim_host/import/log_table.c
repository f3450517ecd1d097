/* POSIX: strdup, strndup. */
#define _XOPEN_SOURCE 700

#include "log_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool out_of_memory(const log_table *t, error *e)
{
    return error_failure(e, 0, "%s: out of memory", t->path);
}

static bool read_head(log_table *t, error *e)
{
    log_head *head = &t->head;
    while (head->lines < LOG_HEAD_LINES && log_text_next(&t->text, e)) {
        char *copy = malloc(t->text.length + 1);
        if (copy == NULL) {
            return out_of_memory(t, e);
        }
        memcpy(copy, t->text.line, t->text.length);
        head->line[head->lines] = copy;
        head->length[head->lines++] = t->text.length;
    }
    return e->status == STATUS_DONE;
}

/* The fields of a line of the head as strings of their own. */
static char **take_words(log_table *t, size_t k, log_field *fields, size_t *count)
{
    const int got = log_line_split(t->head.line[k], t->head.length[k], t->format.delimiter, fields);
    char **words = calloc(LOG_FIELDS_MOST, sizeof *words);
    *count = got > 0 ? (size_t)got : 0;
    for (size_t n = 0; words != NULL && n < *count; n++) {
        words[n] = strndup(fields[n].text, fields[n].length);
    }
    return words;
}

static bool take_names(log_table *t, error *e)
{
    log_field *fields = malloc(LOG_FIELDS_MOST * sizeof *fields);
    size_t units = 0;
    if (fields == NULL) {
        return out_of_memory(t, e);
    }
    t->name = take_words(t, t->head.has_header ? t->head.header : t->head.first_row, fields, &t->columns);
    if (t->head.has_units) {
        t->unit = take_words(t, t->head.units, fields, &units);
    } else {
        t->unit = calloc(LOG_FIELDS_MOST, sizeof *t->unit);
    }
    free(fields);
    if (t->name == NULL || t->unit == NULL) {
        return out_of_memory(t, e);
    }
    while (t->head.has_header && t->columns > 0 && t->name[t->columns - 1] != NULL &&
           t->name[t->columns - 1][0] == '\0') {
        free(t->name[--t->columns]); /* a delimiter at the end of the line makes no column */
        t->name[t->columns] = NULL;
    }
    for (size_t n = 0; n < t->columns; n++) {
        if (!t->head.has_header) {
            char number[24];
            snprintf(number, sizeof number, "%zu", n + 1);
            free(t->name[n]);
            t->name[n] = strdup(number);
        }
        if (t->unit[n] == NULL) {
            t->unit[n] = strdup("");
        }
        if (t->name[n] == NULL || t->unit[n] == NULL) {
            return out_of_memory(t, e);
        }
    }
    return true;
}

bool log_table_open(log_table *t, const char *path, const log_format *said, error *e)
{
    *t = (log_table){.path = strcmp(path, "-") == 0 ? "stdin" : path, .format = *said};
    const bool ok = log_text_open(&t->text, path, said->encoding, e) && read_head(t, e) &&
                    log_format_find(&t->format, &t->head, t->path, e);
    /* The first row is split once more when it is read: names are taken from a copy where there is no header. */
    if (ok && !t->head.has_header) {
        const size_t k = t->head.first_row;
        char *whole = t->head.line[k];
        char *copy = malloc(t->head.length[k] + 1);
        if (copy == NULL) {
            return out_of_memory(t, e);
        }
        memcpy(copy, whole, t->head.length[k]);
        t->head.line[k] = copy;
        const bool named = take_names(t, e);
        free(copy);
        t->head.line[k] = whole;
        return named;
    }
    return ok && take_names(t, e);
}

size_t log_table_find(const log_table *t, const char *name)
{
    size_t n = 0;
    while (n < t->columns && strcmp(t->name[n], name) != 0) {
        n++;
    }
    return n;
}

/* ---- rows ---- */

typedef struct row_reader {
    log_table *t;
    const bool *wanted;
    size_t last_wanted;
    size_t room;
    char *copy; /* the line, so that it may be unquoted in place */
    size_t copy_size;
    log_field fields[LOG_FIELDS_MOST];
    error *e;
} row_reader;

static bool grow(row_reader *r)
{
    log_table *t = r->t;
    const size_t room = r->room == 0 ? 4096 : 2 * r->room;
    long *line = realloc(t->line, room * sizeof *line);
    if (line == NULL) {
        return out_of_memory(t, r->e);
    }
    t->line = line;
    for (size_t n = 0; n < t->columns; n++) {
        double *grown = r->wanted[n] ? realloc(t->value[n], room * sizeof *grown) : NULL;
        if (r->wanted[n] && grown == NULL) {
            return out_of_memory(t, r->e);
        }
        t->value[n] = grown;
    }
    r->room = room;
    return true;
}

/* The character, from 1, at a byte of a line. */
static long column_of(const char *line, size_t offset)
{
    long column = 1;
    for (size_t k = 0; k < offset; k++) {
        column += ((unsigned char)line[k] & 0xC0) != 0x80 ? 1 : 0;
    }
    return column;
}

static bool take_row(row_reader *r, const char *line, size_t length, long number)
{
    log_table *t = r->t;
    if (r->copy == NULL || length + 1 > r->copy_size) {
        char *grown = realloc(r->copy, 2 * (length + 1));
        if (grown == NULL) {
            return out_of_memory(t, r->e);
        }
        r->copy = grown;
        r->copy_size = 2 * (length + 1);
    }
    memcpy(r->copy, line, length);
    const int count = log_line_split(r->copy, length, t->format.delimiter, r->fields);
    if (count < 0) {
        return error_input(r->e, t->path, number, 0,
                           count == -1 ? "a quoted field has no end on its line" : "more than 1024 fields");
    }
    if (count == 1 && r->fields[0].length == 0) {
        return true; /* a blank line */
    }
    if ((size_t)count <= r->last_wanted) {
        return error_input(r->e, t->path, number, 1,
                           "the row has %d field%s, the header has %zu; is the file cut off?", count,
                           count == 1 ? "" : "s", t->columns);
    }
    if (t->rows == r->room && !grow(r)) {
        return false;
    }
    for (size_t n = 0; n <= r->last_wanted; n++) {
        const log_field *f = &r->fields[n];
        if (r->wanted[n] && !log_field_number(f, t->format.decimal, &t->value[n][t->rows])) {
            return error_input(r->e, t->path, number, column_of(line, f->offset),
                               "%s \"%.*s\" is no finite number (decimal mark \"%c\")", t->name[n],
                               f->length > 40 ? 40 : (int)f->length, f->text, t->format.decimal);
        }
    }
    t->line[t->rows++] = number;
    return true;
}

/* Also true for a row that may be left out. */
static bool take_row_or_skip(row_reader *r, const char *line, size_t length, long number)
{
    if (take_row(r, line, length, number)) {
        return true;
    }
    if (!r->t->skip_bad || r->e->status != STATUS_UNUSABLE) {
        return false;
    }
    if (r->t->skipped++ == 0) {
        r->t->first_skipped = *r->e;
    }
    *r->e = (error){0};
    return true;
}

/* The columns are there; that their numbers are finite is still to be asked, of those that are wanted. */
static bool check_held(const log_table *t, const bool *wanted, error *e)
{
    for (size_t n = 0; n < t->columns; n++) {
        for (size_t k = 0; wanted[n] && k < t->rows; k++) {
            if (!isfinite(t->value[n][k])) {
                return error_input(e, t->path, t->line[k], 0, "%s is no finite number", t->name[n]);
            }
        }
    }
    return true;
}

bool log_table_hold(log_table *t, const char *path, size_t columns, const char *const *name,
                    const double *const *value, size_t rows, error *e)
{
    *t = (log_table){.path = path, .held = true, .rows = rows};
    if (columns > LOG_FIELDS_MOST) {
        return error_input(e, path, 0, 0, "%zu columns; expected %d at most", columns, LOG_FIELDS_MOST);
    }
    t->name = calloc(columns + 1, sizeof *t->name);
    t->value = calloc(columns + 1, sizeof *t->value);
    t->line = calloc(rows + 1, sizeof *t->line);
    t->unit = calloc(LOG_FIELDS_MOST, sizeof *t->unit);
    bool ok = t->name != NULL && t->value != NULL && t->line != NULL && t->unit != NULL;
    for (size_t n = 0; ok && n < columns; n++) {
        t->columns = n + 1;
        t->name[n] = strdup(name[n]);
        t->unit[n] = strdup("");
        t->value[n] = malloc((rows + 1) * sizeof **t->value);
        ok = t->name[n] != NULL && t->unit[n] != NULL && t->value[n] != NULL;
        if (ok && rows > 0) {
            memcpy(t->value[n], value[n], rows * sizeof **t->value);
        }
    }
    for (size_t k = 0; ok && k < rows; k++) {
        t->line[k] = (long)k + 1;
    }
    return ok || out_of_memory(t, e);
}

bool log_table_read(log_table *t, const bool *wanted, error *e)
{
    if (t->held) {
        return check_held(t, wanted, e);
    }
    row_reader *r = calloc(1, sizeof *r);
    t->value = calloc(t->columns + 1, sizeof *t->value);
    if (r == NULL || t->value == NULL) {
        free(r);
        return out_of_memory(t, e);
    }
    r->t = t;
    r->wanted = wanted;
    r->e = e;
    for (size_t n = 0; n < t->columns; n++) {
        r->last_wanted = wanted[n] ? n : r->last_wanted;
    }
    bool ok = true;
    for (size_t k = t->head.first_row; ok && k < t->head.lines; k++) {
        ok = take_row_or_skip(r, t->head.line[k], t->head.length[k], (long)k + 1);
    }
    while (ok && log_text_next(&t->text, e)) {
        ok = take_row_or_skip(r, t->text.line, t->text.length, t->text.number);
    }
    free(r->copy);
    free(r);
    return ok && e->status == STATUS_DONE;
}

void log_table_close(log_table *t)
{
    for (size_t n = 0; t->name != NULL && n < t->columns; n++) {
        free(t->name[n]);
        free(t->value != NULL ? t->value[n] : NULL);
    }
    for (size_t n = 0; t->unit != NULL && n < LOG_FIELDS_MOST; n++) {
        free(t->unit[n]);
    }
    for (size_t k = 0; k < t->head.lines; k++) {
        free(t->head.line[k]);
    }
    free(t->name);
    free(t->unit);
    free(t->value);
    free(t->line);
    log_text_close(&t->text);
    *t = (log_table){0};
}

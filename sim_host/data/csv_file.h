/*
 * A CSV file (RFC 4180) as records of fields, with the line and column of every field.
 *
 * It reads line by line, so the line is always known; the column is computed only for an error. A line without quotes is split at its
 * commas directly; recordings have no other lines. A byte order mark, and comments (#) and blank lines ahead of the first record, are
 * skipped.
 */
#ifndef SIM_HOST_DATA_CSV_FILE_H
#define SIM_HOST_DATA_CSV_FILE_H

#include "../base/error.h"
#include "line_source.h"

#include <stddef.h>

enum { CSV_FILE_LINES_WITHOUT_RECORD = 1000000 };

/* A field, unquoted and without the spaces around it, not 0-terminated; index from 0 within its record. */
typedef void csv_field_fn(void *context, size_t index, const char *text, size_t length);

/* The end of a record of so many fields. */
typedef void csv_record_fn(void *context, size_t fields);

/* A comment line ahead of the first record, with its '#'; number: of the line. */
typedef void csv_comment_fn(void *context, const char *text, size_t length, long number);

typedef struct csv_file {
    csv_field_fn *on_field;
    csv_record_fn *on_record;
    csv_comment_fn *on_comment; /* or NULL */
    void *context;
    error *e; /* set by anyone: reading stops, and no callback is called any more */

    line_source lines;
    const char *text; /* the raw text of the present record */
    size_t text_length;
    char *record; /* its copy where it has several lines: a quoted field may hold line breaks */
    size_t record_length, record_size;
    long record_line; /* the line on which it starts */
    long last_line;   /* the line on which the last record ended */
    size_t field;     /* how many of its fields have been seen */
    bool started;     /* the first record has been seen */
} csv_file;

/* Reads it all. The caller has set the callbacks, context and e, and the rest to 0. "-" is stdin. */
bool csv_file_read(csv_file *f, const char *path);

/* Within a callback: an error at the start of field `index` of the present record. */
void csv_file_refuse(csv_file *f, size_t index, const char *format, ...) ERROR_PRINTF(3, 4);

/* Safe on a zeroed struct. */
void csv_file_free(csv_file *f);

#endif

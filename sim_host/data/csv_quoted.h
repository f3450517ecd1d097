/*
 * Records in which something is quoted (RFC 4180), fed line by line: a quoted field may hold commas, line ends and doubled
 * quotes. CR and LF each end a record; a line of blanks is none.
 */
#ifndef SIM_HOST_DATA_CSV_QUOTED_H
#define SIM_HOST_DATA_CSV_QUOTED_H

#include <stdbool.h>
#include <stddef.h>

/* A field, unquoted and without the spaces around it, not 0-terminated; then the record's end. */
typedef void csv_quoted_field_fn(void *context, const char *text, size_t length);
typedef void csv_quoted_record_fn(void *context);

typedef enum csv_quoted_state {
    CSV_BEFORE_RECORD,
    CSV_BEFORE_FIELD,
    CSV_IN_FIELD,
    CSV_IN_QUOTES,
    CSV_AFTER_QUOTE /* the field's end, or the first of a doubled quote */
} csv_quoted_state;

typedef struct csv_quoted {
    csv_quoted_field_fn *on_field;
    csv_quoted_record_fn *on_record;
    void *context;

    csv_quoted_state state;
    char *field; /* the field so far, grown to the longest */
    size_t length, size;
    size_t blanks; /* at its end, outside quotes */
} csv_quoted;

typedef enum csv_quoted_result {
    CSV_QUOTED_OK,
    CSV_QUOTED_STRAY, /* a quote within a field, or text after its closing quote */
    CSV_QUOTED_NO_MEMORY
} csv_quoted_result;

/* The caller has set the callbacks, and the rest to 0. */
csv_quoted_result csv_quoted_feed(csv_quoted *q, const char *text, size_t length);

/* The end of the file; false within quotes. */
bool csv_quoted_end(csv_quoted *q);

/* Safe on a zeroed struct. */
void csv_quoted_free(csv_quoted *q);

#endif

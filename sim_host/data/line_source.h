/*
 * Reads the lines of a text file, plain or gzip (recognised by its first bytes), or of stdin ("-"). Lines are numbered from 1.
 */
#ifndef SIM_HOST_DATA_LINE_SOURCE_H
#define SIM_HOST_DATA_LINE_SOURCE_H

#include "../base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    /* No recording has lines this long; a binary file, which may have no line end, is not to fill memory. */
    LINE_SOURCE_LONGEST = 1024 * 1024
};

typedef struct line_source {
    const char *path; /* for messages: "stdin" for "-" */
    struct byte_source *bytes_of;
    char *buffer; /* bytes that were read: those from at to end precede the next line */
    size_t offset, end;
    bool is_end;      /* there is no more to read */
    const char *line; /* the current line with its newline, if it has one; may hold zeros */
    size_t length;
    long number;    /* of the current line */
    uint64_t bytes; /* of all that was read, unpacked */
} line_source;

/* `path` must outlive the struct. */
bool line_source_open(line_source *s, const char *path, error *e);

/*
 * The next line into ->line, ->length, ->number, valid until the next call. False at the end, or with *e set on damage, a line or a
 * file that is too long.
 */
bool line_source_next(line_source *s, error *e);

/*
 * For callers that split lines themselves: the next bytes as they come, valid until the next call. Not to be mixed with
 * line_source_next. False at the end, or with *e set on damage.
 */
bool line_source_block(line_source *s, char **bytes, size_t *length, error *e);

/* Safe on a zeroed struct. */
void line_source_close(line_source *s);

#endif

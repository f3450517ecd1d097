/*
 * Format of a foreign table: delimiter, decimal mark and header line, detected from its first lines or given by the map. A delimiter and
 * a decimal mark are right if they make numbers of most fields.
 */
#ifndef SIM_HOST_IMPORT_LOG_FORMAT_H
#define SIM_HOST_IMPORT_LOG_FORMAT_H

#include "log_text.h"

enum {
    LOG_FIELDS_MOST = 1024,
    LOG_HEAD_LINES = 200 /* as many are looked at for the format */
};

typedef struct log_format {
    log_encoding encoding; /* ENCODING_AUTO: to be found */
    char delimiter;        /* ',' ';' '\t', ' ' for any blanks; 0: to be found */
    char decimal;          /* '.' or ','; 0: to be found */
    long skip;             /* lines ahead of the header; -1: to be found */
} log_format;

#define LOG_FORMAT_UNKNOWN                                                                                   \
    {                                                                                                        \
        ENCODING_AUTO, 0, 0, -1                                                                              \
    }

typedef struct log_field {
    const char *text; /* unquoted, without the blanks around it; not 0-terminated */
    size_t length;
    size_t offset; /* where it starts in the line, bytes from 0 */
} log_field;

typedef struct log_head {
    char *line[LOG_HEAD_LINES];
    size_t length[LOG_HEAD_LINES];
    size_t lines;
    bool has_header, has_units;
    size_t header, units, first_row; /* indices of lines; first_row may be `lines` */
} log_head;

/*
 * Splits a line; the text is unquoted in place. -1 if a quoted field has no end, -2 if there are more than
 * LOG_FIELDS_MOST. Empty fields at the end, which some programs write, count.
 */
int log_line_split(char *line, size_t length, char delimiter, log_field *fields);

/* The number of a field with this decimal mark; false if it is none. */
bool log_field_number(const log_field *f, char decimal, double *value);

/* Completes the format and finds header, unit row and first row of numbers. False with *e set. */
bool log_format_find(log_format *f, log_head *head, const char *path, error *e);

#endif

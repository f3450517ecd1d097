/*
 * A foreign log as a table: the names in its header, and those columns of numbers that are asked for.
 */
#ifndef SIM_HOST_IMPORT_LOG_TABLE_H
#define SIM_HOST_IMPORT_LOG_TABLE_H

#include "log_format.h"

typedef struct log_table {
    const char *path;
    log_text text;
    log_format format; /* as found */
    log_head head;
    size_t columns;
    char **name; /* of each; "1", "2" ... where the log has no header */
    char **unit; /* from the unit row; "" without one */
    size_t rows;
    double **value; /* [column], NULL if it was not asked for */
    long *line;     /* of each row */
    bool held;      /* its columns are the caller's, in memory */
    bool
        skip_bad; /* set by the caller before log_table_read: rows that cannot be read are left out and counted */
    size_t skipped;
    error first_skipped; /* why the first of them was */
} log_table;

/* Reads the first lines. `said` may be unknown; `path` must outlive the struct, "-" is stdin. */
bool log_table_open(log_table *t, const char *path, const log_format *said, error *e);

/* A table in memory, all its columns read: what other libraries read of formats that are not text. `path` is what
 * messages call it. Copies all but `path`. */
bool log_table_hold(log_table *t, const char *path, size_t columns, const char *const *name,
                    const double *const *value, size_t rows, error *e);

/* The index of a name, or ->columns. */
size_t log_table_find(const log_table *t, const char *name);

/* Reads all rows; of each column with wanted[] true, every field must be a number, or else the row is left
 * out if skip_bad is set. */
bool log_table_read(log_table *t, const bool *wanted, error *e);

/* Safe on a zeroed struct. */
void log_table_close(log_table *t);

#endif

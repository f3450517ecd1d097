/*
 * A log's columns in the recording's units: scale, offset, unit, pole pairs and zero of the map applied.
 */
#ifndef SIM_HOST_IMPORT_LOG_COLUMNS_H
#define SIM_HOST_IMPORT_LOG_COLUMNS_H

#include "data/motor.h"
#include "log_table.h"
#include "map.h"

typedef struct log_columns {
    size_t rows;
    double *value[QUANTITY_COUNT]; /* NULL if the map does not have it */
    long *line;                    /* of each row in the log; belongs to the table */
} log_columns;

/* Reads the table. False with *e set: a column that is not there, a row that cannot be used. */
bool columns_read(log_columns *c, log_table *t, const import_map *map, const motor *m, error *e);

/* Have all `count` quantities from `first` on. */
bool columns_have(const log_columns *c, quantity first, int count);

/* Safe on a zeroed struct. */
void columns_free(log_columns *c);

#endif

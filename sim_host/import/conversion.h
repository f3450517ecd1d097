/*
 * A conversion in progress: the log, its map and the recording that is made, as the steps of convert.c share
 * them.
 */
#ifndef SIM_HOST_IMPORT_CONVERSION_H
#define SIM_HOST_IMPORT_CONVERSION_H

#include "data/motor.h"
#include "data/recording.h"
#include "log_columns.h"
#include "log_table.h"
#include "map.h"

typedef struct conversion {
    const log_table *t;
    const import_map *map;
    const motor *motor; /* NULL: none was given */
    log_columns c;
    recording *r;
    error *e;
} conversion;

/* Sets the error; returns false. */
bool conversion_out_of_memory(const conversion *v);

/* A column of as many rows as the log has, all 0; NULL with the error set. */
double *conversion_column(const conversion *v);

/* Three at once; false with the error set. */
bool conversion_three(const conversion *v, double *column[3]);

/* How many of `count` quantities from `first` on the map has. */
int conversion_has(const conversion *v, quantity first, int count);

#endif

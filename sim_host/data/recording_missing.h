/*
 * What a recording's header lacks, all at once, and how its columns would stand in a map if they look like
 * another program's.
 */
#ifndef SIM_HOST_DATA_RECORDING_MISSING_H
#define SIM_HOST_DATA_RECORDING_MISSING_H

#include "csv_file.h"

typedef struct recording_missing {
    char list[200]; /* "t_s, i_a_A" */
    char hint[160]; /* "i_a_A = "Ia [mA]"" */
} recording_missing;

/* A column that a recording does not have. */
void recording_missing_note(recording_missing *m, const char *name, size_t length);

/* One that it should have. */
void recording_missing_add(recording_missing *m, const char *what);

/* The error, at the header. */
void recording_missing_refuse(const recording_missing *m, csv_file *csv);

#endif

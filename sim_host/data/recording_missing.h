/*
 * The columns missing in a recording's header, all in one message, with a proposed map if the names look like another program's.
 */
#ifndef SIM_HOST_DATA_RECORDING_MISSING_H
#define SIM_HOST_DATA_RECORDING_MISSING_H

#include "csv_file.h"
#include "recording_columns.h"

typedef struct recording_missing {
    char list[200]; /* "t_s, i_a_A" */
    char hint[160]; /* "i_a_A = "Ia [mA]"" */
} recording_missing;

/* A column that a recording does not have. */
void recording_missing_note(recording_missing *m, const char *name, size_t length);

/* Finds the required columns that are missing. */
void recording_missing_find(recording_missing *m, const bool have[COL_COUNT]);

/* "missing columns: t_s, i_a_A", and the header found instead, cut to `length`, with a hint how a map would read it. */
void recording_missing_words(const recording_missing *m, const char *found, size_t length, char *text,
                             size_t size);

/* The error, at the header. */
void recording_missing_refuse(const recording_missing *m, csv_file *csv);

#endif

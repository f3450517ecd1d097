/*
 * Converts the recorder's rows to a recording (docs/interfaces.md): vectors become phases, each stretch gets
 * its own run.
 */
#ifndef SIM_HOST_RECORD_RECORD_ROWS_H
#define SIM_HOST_RECORD_RECORD_ROWS_H

#include "data/recording_columns.h"
#include "wire_reader.h"

typedef struct record_rows {
    recording recording;
    size_t capacity;
    bool begun;
    bool have[COL_COUNT]; /* the columns that the first row's header gives */
    long run;
    wire_header header; /* of the first row: the columns */
    error e;            /* why a row was refused */
} record_rows;

/* A wire_take_row; context: record_rows, zeroed. False, with e set: no recording can hold the stream. */
bool record_rows_take(void *context, const wire_header *header, const wire_row *row);

void record_rows_free(record_rows *rows);

enum { RECORD_COMMENT = 256 };

/* The comment of the recording: what came and what is missing. */
void record_comment(const wire_counts *c, char *text, size_t size);

#endif

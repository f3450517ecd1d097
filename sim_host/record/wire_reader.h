/*
 * Reads the recorder's stream (docs/recorder-format.md) byte by byte: returns complete frames and counts damaged ones.
 *
 * Nothing is guessed: a frame whose CRC is wrong, whose length does not fit its type, or that precedes any header gives no rows. What is
 * between frames - boot messages, a burst of noise - is counted as damage and passed over.
 */
#ifndef SIM_HOST_RECORD_WIRE_READER_H
#define SIM_HOST_RECORD_WIRE_READER_H

#include "iqfoc/recorder.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Longest frame in words, its CRC included: eight rows of 16 channels. */
#define WIRE_WORDS_MAX (4 + 8 * (IQFOC_RECORDER_CHANNELS_MAX + 1) + 1)

typedef struct wire_channel {
    uint32_t column;
    double scale; /* host units per step */
} wire_channel;

typedef struct wire_header {
    uint32_t stream;
    double T_s;
    uint32_t decimation;
    size_t channels;
    wire_channel channel[IQFOC_RECORDER_CHANNELS_MAX];
} wire_header;

typedef struct wire_counts {
    unsigned long frames;        /* whole ones */
    unsigned long damaged;       /* pieces between frame marks that are no frame */
    unsigned long lost_frames;   /* missing from the sequence */
    unsigned long lost_rows;     /* that the target had no room for, as it says itself */
    unsigned long headless_rows; /* whole, but before any header of their stream */
    /*
     * Every row that the target took and that was not given to the caller, wherever it was lost: between two
     * rows by the numbers of their cycles, before the first and after the last by the end frame. Without that
     * frame the latter two are not known.
     */
    unsigned long missing_rows;
} wire_counts;

/* The target's answer to a request (wire_request.h): what it has set, or the error for which it has not. */
typedef struct wire_answer {
    uint32_t stream;
    int32_t error; /* iqfoc_error_t */
    uint32_t sequence;
    iqfoc_recorder_setting_t setting;
} wire_answer;

/* A row of the present stream. */
typedef struct wire_row {
    uint32_t cycle;
    const int32_t *value; /* one per channel */
    bool after_gap;       /* a row is missing between this one and the last, or a new stream begins */
} wire_row;

/* Called for each row; false stops the reader. */
typedef bool wire_take_row(void *context, const wire_header *header, const wire_row *row);

typedef struct wire_reader {
    wire_header header;
    wire_counts counts;
    bool header_known;
    bool ended;         /* the present stream's end frame has come */
    uint32_t version;   /* of a frame with another version than ours, else 0 */
    uint32_t rows_sent; /* as the end frame says */
    unsigned long answers;
    wire_answer answer; /* the last one */
    /* Private. */
    bool sequence_known;
    uint32_t sequence;
    bool gap;
    bool row_known;
    uint32_t last_cycle;
    uint32_t last_lost;
    unsigned long stream_rows, stream_missing; /* of the present stream */
    bool in_escape;
    bool broken; /* the present piece is no frame any more */
    size_t octets;
    uint8_t data[4 * WIRE_WORDS_MAX];
    int32_t row[IQFOC_RECORDER_CHANNELS_MAX];
} wire_reader;

/* Zero-initialised to begin with. False if `take` returned false. */
bool wire_read(wire_reader *reader, const uint8_t *octets, size_t count, wire_take_row *take, void *context);

/* The line is closed: what has come of an unfinished frame counts as damaged. */
void wire_close(wire_reader *reader);

#endif

/* Common parts of the recorder's tests: a recorder of three counted channels, and a sink for the host's reader. */
#ifndef TESTS_UNIT_RECORDER_LINE_H
#define TESTS_UNIT_RECORDER_LINE_H

#include "wire_reader.h"

#include "iqfoc/recorder.h"

#include <stdlib.h>
#include <string.h>

#define LINE_CHANNELS 3
#define LINE_ROWS_MAX 4096

/* What the channels hold in a cycle: octets of all kinds, those with a meaning on the wire included. */
static inline int32_t line_value(uint32_t cycle, size_t channel)
{
    static const uint32_t base[LINE_CHANNELS] = {0xC0DBDCDD, 0x01000193, 0xDBC0DBC0};
    return (int32_t)(base[channel] * (2 * cycle + 1));
}

/* A row of these channels in each cycle, from now on; a cycle lasts 2e-4 s. */
static inline iqfoc_recorder_config_t line_config(const int32_t source[LINE_CHANNELS])
{
    const iqfoc_recorder_config_t config = {
        .channels = {{&source[0], IQFOC_RECORDER_I_ALPHA, 997000000, 50},
                     {&source[1], IQFOC_RECORDER_I_BETA, 997000000, 50},
                     {&source[2], IQFOC_RECORDER_THETA_E, 1686629713, 52}},
        .channel_count = LINE_CHANNELS,
        .decimation = 1,
        .period_mantissa = 1759218604,
        .period_shift = 43,
        .trigger = IQFOC_RECORDER_NOW,
    };
    return config;
}

/* A cycle of the recorder with the channels' values. */
static inline void line_record(iqfoc_recorder_t *recorder, int32_t source[LINE_CHANNELS], uint32_t cycle,
                               uint32_t status)
{
    for (size_t c = 0; c < LINE_CHANNELS; c++) {
        source[c] = line_value(cycle, c);
    }
    iqfoc_recorder_take(recorder, status);
}

/* Rows as the host got them. */
typedef struct line_rows {
    size_t count;
    uint32_t cycle[LINE_ROWS_MAX];
    bool after_gap[LINE_ROWS_MAX];
    size_t false_values; /* rows whose values are not what the cycle held */
} line_rows;

static inline bool line_take(void *context, const wire_header *header, const wire_row *row)
{
    line_rows *rows = context;
    if (rows->count == LINE_ROWS_MAX) {
        return false;
    }
    rows->cycle[rows->count] = row->cycle;
    rows->after_gap[rows->count++] = row->after_gap;
    for (size_t c = 0; c < header->channels; c++) {
        if (row->value[c] != line_value(row->cycle, c)) {
            rows->false_values++;
            break;
        }
    }
    return true;
}

#endif

/* Common parts of the recorder's tests: a recorder of three counted channels, and a sink for the host's reader. */
#ifndef TESTS_UNIT_RECORDER_LINE_H
#define TESTS_UNIT_RECORDER_LINE_H

#include "wire_reader.h"

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

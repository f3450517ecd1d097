/* A column of numbers in a page, compact (chart.h). */
#ifndef SIM_HOST_REPORT_CHART_COLUMN_H
#define SIM_HOST_REPORT_CHART_COLUMN_H

#include <stddef.h>
#include <stdio.h>

/* `count` numbers, `stride` doubles apart. */
typedef struct chart_column {
    const double *at;
    size_t stride, count;
} chart_column;

/*
 * An axis. Pieces that rise evenly, {"pieces":[[first, step, count], ...]}, exact to a hundredth of the step; where
 * there are too many of them the doubles themselves, {"f8":"..."} in base64 and little-endian.
 */
void chart_column_x(FILE *out, const chart_column *c);

/*
 * Values. {"f4":"..."}: 32-bit floating point, NaN a gap. Of more than CHART_EXACT values
 * {"i2":"...","middle":m,"step":s}: 16-bit n stands for m + n s, and -32768 for a gap.
 */
void chart_column_y(FILE *out, const chart_column *c);

#endif

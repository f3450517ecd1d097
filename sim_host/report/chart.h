/*
 * Charts of a report page: curves with their axes, drawn by the reader's browser (page.js, with uPlot), where he
 * zooms, reads values and leaves curves out. No other program is needed.
 *
 *     chart_data d = chart_data_of(2);
 *     chart_data_add(&d, (double[]){x, y}); ...
 *     const chart drawn = {.x_label = "time, s", .y_label = "current, A", .series = {{"measured", &d, 1}}};
 *     ok = page_chart(p, &drawn, "current", "What was measured.", e);      (page.h)
 *     chart_data_free(&d);
 *
 * In the page stand the numbers themselves: in 32-bit floating point, and where a column has more than CHART_EXACT
 * values in 16 bits over its own range, so that a million rows stay a few megabytes a column.
 */
#ifndef SIM_HOST_REPORT_CHART_H
#define SIM_HOST_REPORT_CHART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { CHART_SERIES = 8, CHART_EXACT = 4096 };

/* Rows of numbers. Column 0 is x and rises; NAN in another is a gap. */
typedef struct chart_data {
    size_t columns, rows, room;
    double *value;
    bool lost; /* memory ran out: the chart will not be written */
} chart_data;

chart_data chart_data_of(size_t columns);
void chart_data_add(chart_data *d, const double *row);
void chart_data_free(chart_data *d);

/* In colours that stay apart for every common kind of colour vision, each in a light and a dark variant. */
typedef enum chart_colour { CHART_BLUE, CHART_ORANGE, CHART_GREEN, CHART_PURPLE, CHART_FAINT } chart_colour;
/* As the style sheet calls it: "blue". */
const char *chart_colour_name(chart_colour colour);
typedef enum chart_mark { CHART_LINE, CHART_POINTS, CHART_LINE_POINTS, CHART_STEPS, CHART_BARS } chart_mark;
/* Which of the page's two switches shows and hides it. */
typedef enum chart_role { CHART_ALWAYS, CHART_NOMINAL, CHART_EXTENDED } chart_role;

typedef struct chart_series {
    const char *label;
    const chart_data *data;
    size_t column;
    chart_colour colour;
    chart_mark mark;
    chart_role role;
    double width; /* of the line; 0: as usual */
    bool dashed;
} chart_series;

typedef struct chart_axis {
    bool logarithmic;
    bool fixed; /* from low to high; else as the numbers are */
    double low, high;
    double least; /* an axis that is not fixed reaches from -least to least at least */
} chart_axis;

/* All texts are plain. */
typedef struct chart {
    const char *title; /* or NULL */
    const char *x_label, *y_label;
    const char
        *group; /* charts of one group are zoomed together and have one cursor; NULL: each for itself */
    chart_axis x, y;
    const char *const *name; /* of the places 0, 1, ... along x, where they are no numbers */
    size_t names;
    double view_low, view_high;        /* what is shown first; nothing where both are 0: all */
    int height;                        /* px; 0: as usual */
    chart_series series[CHART_SERIES]; /* up to the first without a label */
} chart;

/* Writes some charts as the JSON that page.js reads; what HTML holds special is escaped. False: a chart's data were lost. */
bool chart_write(FILE *out, const chart *charts, size_t count);

#endif

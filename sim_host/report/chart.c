/* Charts as JSON (chart.h). */
#include "chart.h"

#include "chart_column.h"

#include <stdlib.h>
#include <string.h>

chart_data chart_data_of(size_t columns)
{
    return (chart_data){.columns = columns};
}

void chart_data_add(chart_data *d, const double *row)
{
    if (d->rows == d->room && !d->lost) {
        const size_t room = d->room > 0 ? 2 * d->room : 64;
        double *grown = realloc(d->value, room * d->columns * sizeof *grown);
        if (grown != NULL) {
            d->value = grown;
            d->room = room;
        } else {
            d->lost = true;
        }
    }
    if (!d->lost) {
        memcpy(&d->value[d->rows * d->columns], row, d->columns * sizeof *row);
        d->rows++;
    }
}

void chart_data_free(chart_data *d)
{
    free(d->value);
    *d = (chart_data){.columns = d->columns};
}

/* Text between JSON's quotes, safe inside a <script>. */
static void write_text(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c < 0x20 || strchr("\"\\<>&'", c) != NULL) {
            fprintf(out, "\\u%04x", c);
        } else {
            fputc(c, out);
        }
    }
}

static void put_text(FILE *out, const char *key, const char *text)
{
    if (text != NULL) {
        fprintf(out, ",\"%s\":\"", key);
        write_text(out, text);
        fputc('"', out);
    }
}

/* ---- Columns, each once ---- */

typedef struct column_list {
    size_t count;
    struct {
        const chart_data *data;
        size_t column;
    } of[256];
} column_list;

/* The place of a column; it is added where it is not there. */
static size_t place_of(column_list *list, const chart_data *data, size_t column)
{
    size_t n = 0;
    while (n < list->count && (list->of[n].data != data || list->of[n].column != column)) {
        n++;
    }
    if (n == list->count && n < sizeof list->of / sizeof list->of[0]) {
        list->of[n].data = data;
        list->of[n].column = column;
        list->count++;
    }
    return n;
}

static void put_columns(FILE *out, const column_list *list)
{
    fputs("\"columns\":[", out);
    for (size_t n = 0; n < list->count; n++) {
        const chart_data *d = list->of[n].data;
        const chart_column c = {d->value != NULL ? &d->value[list->of[n].column] : NULL, d->columns, d->rows};
        fputs(n > 0 ? ",\n" : "", out);
        if (list->of[n].column == 0) {
            chart_column_x(out, &c);
        } else {
            chart_column_y(out, &c);
        }
    }
    fputc(']', out);
}

/* ---- Charts ---- */

static void put_axis(FILE *out, const char *key, const char *label, const chart_axis *axis)
{
    fprintf(out, ",\"%s\":{\"log\":%s", key, axis->logarithmic ? "true" : "false");
    put_text(out, "label", label);
    if (axis->fixed) {
        fprintf(out, ",\"range\":[%.9g,%.9g]", axis->low, axis->high);
    }
    if (axis->least > 0.0) {
        fprintf(out, ",\"least\":%.9g", axis->least);
    }
    fputc('}', out);
}

const char *chart_colour_name(chart_colour colour)
{
    static const char *const names[] = {"blue", "orange", "green", "purple", "faint"};
    return names[colour];
}

static void put_series(FILE *out, const chart_series *s, column_list *list)
{
    static const char *const marks[] = {"line", "points", "linepoints", "steps", "bars"};
    static const char *const roles[] = {"", "nominal", "extended"};
    const size_t x = place_of(list, s->data, 0);
    const size_t y = place_of(list, s->data, s->column);
    fprintf(
        out,
        "{\"x\":%zu,\"y\":%zu,\"colour\":\"%s\",\"mark\":\"%s\",\"role\":\"%s\",\"width\":%g,\"dashed\":%s",
        x, y, chart_colour_name(s->colour), marks[s->mark], roles[s->role], s->width,
        s->dashed ? "true" : "false");
    put_text(out, "label", s->label);
    fputc('}', out);
}

static void put_chart(FILE *out, const chart *c, column_list *list)
{
    fprintf(out, "{\"height\":%d", c->height);
    put_text(out, "title", c->title);
    put_text(out, "group", c->group);
    put_axis(out, "x", c->x_label, &c->x);
    put_axis(out, "y", c->y_label, &c->y);
    if (c->view_high > c->view_low) {
        fprintf(out, ",\"view\":[%.9g,%.9g]", c->view_low, c->view_high);
    }
    for (size_t n = 0; n < c->names; n++) {
        fputs(n > 0 ? ",\"" : ",\"names\":[\"", out);
        write_text(out, c->name[n]);
        fputs(n + 1 < c->names ? "\"" : "\"]", out);
    }
    fputs(",\"series\":[", out);
    for (size_t n = 0; n < CHART_SERIES && c->series[n].label != NULL; n++) {
        fputs(n > 0 ? ",\n" : "", out);
        put_series(out, &c->series[n], list);
    }
    fputs("]}", out);
}

bool chart_write(FILE *out, const chart *charts, size_t count)
{
    column_list list = {.count = 0};
    bool whole = true;
    fputs("{\"charts\":[", out);
    for (size_t n = 0; n < count; n++) {
        for (size_t k = 0; k < CHART_SERIES && charts[n].series[k].label != NULL; k++) {
            whole = whole && !charts[n].series[k].data->lost;
        }
        fputs(n > 0 ? ",\n" : "", out);
        put_chart(out, &charts[n], &list);
    }
    fputs("],\n", out);
    put_columns(out, &list);
    fputs("}\n", out);
    return whole;
}

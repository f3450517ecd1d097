#include "log_columns.h"

#include "base/suggest.h"
#include "base/vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The log's names, as many as fit a message. */
static void list_names(const log_table *t, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (size_t n = 0; n < t->columns && length + strlen(t->name[n]) + 8 < size; n++) {
        length += (size_t)snprintf(text + length, size - length, "%s%s", n == 0 ? "" : ", ", t->name[n]);
    }
}

static bool refuse_absent(const log_table *t, const import_map *map, quantity q, error *e)
{
    const map_column *c = &map->column[q];
    char names[280];
    const char *meant = suggest(c->from, (const char *const *)t->name, t->columns);
    list_names(t, names, sizeof names);
    if (meant != NULL) {
        return error_input(e, map->path, c->line, c->at, "%s: %s has no column \"%s\"; did you mean \"%s\"?",
                           quantity_key(q), t->path, c->from, meant);
    }
    return error_input(e, map->path, c->line, c->at, "%s: %s has no column \"%s\"; it has %s",
                       quantity_key(q), t->path, c->from, names);
}

/* What one unit of the column is in the recording's unit. */
static double factor_of(const map_column *c, const motor *m)
{
    const double one = c->unit->factor != 0.0 ? c->unit->factor : VEC_TWO_PI / c->per_turn;
    return c->mechanical ? one * (double)m->pole_pairs : one;
}

static void apply(const map_column *c, double factor, const double *from, double *to, size_t rows)
{
    for (size_t k = 0; k < rows; k++) {
        to[k] = (c->scale * from[k] + c->offset - c->zero) * factor;
    }
}

/* A duty from counts. */
static void apply_pwm(const map_pwm *p, double *d, size_t rows)
{
    for (size_t k = 0; k < rows; k++) {
        const double duty = 0.5 + (d[k] - p->centre) / p->frame;
        d[k] = p->inverted ? 1.0 - duty : duty;
    }
}

static bool check_duties(const log_columns *c, const log_table *t, const import_map *map, error *e)
{
    for (int q = QUANTITY_D_A; q <= QUANTITY_D_C; q++) {
        for (size_t k = 0; c->value[q] != NULL && k < c->rows; k++) {
            const double d = c->value[q][k];
            if (d < -0.001 || d > 1.001) {
                return error_input(e, t->path, t->line[k], 0, "%s is a duty of %.4g, outside 0 to 1: %s",
                                   quantity_key((quantity)q), d,
                                   map->pwm.there ? "are frame and centre of [pwm] right?"
                                                  : "for compare counts [pwm] frame says how many make 1");
            }
        }
    }
    return true;
}

bool columns_read(log_columns *c, log_table *t, const import_map *map, const motor *m, error *e)
{
    size_t from[QUANTITY_COUNT];
    bool wanted[LOG_FIELDS_MOST] = {false};
    *c = (log_columns){0};
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        const map_column *column = &map->column[q];
        if (!column->there) {
            continue;
        }
        from[q] = log_table_find(t, column->from);
        if (from[q] == t->columns) {
            return refuse_absent(t, map, (quantity)q, e);
        }
        if (column->mechanical && m == NULL) {
            return error_input(e, map->path, column->line, column->at,
                               "%s is mechanical: --motor M.toml has to say the pole pairs",
                               quantity_key((quantity)q));
        }
        wanted[from[q]] = true;
    }
    if (!log_table_read(t, wanted, e)) {
        return false;
    }
    c->rows = t->rows;
    c->line = t->line;
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        if (!map->column[q].there) {
            continue;
        }
        c->value[q] = malloc((t->rows + 1) * sizeof(double));
        if (c->value[q] == NULL) {
            return error_failure(e, 0, "%s: out of memory", t->path);
        }
        apply(&map->column[q], factor_of(&map->column[q], m), t->value[from[q]], c->value[q], t->rows);
        if (q >= QUANTITY_D_A && q <= QUANTITY_D_C && map->pwm.there) {
            apply_pwm(&map->pwm, c->value[q], t->rows);
        }
    }
    return check_duties(c, t, map, e);
}

bool columns_have(const log_columns *c, quantity first, int count)
{
    for (int n = 0; n < count; n++) {
        if (c->value[(int)first + n] == NULL) {
            return false;
        }
    }
    return true;
}

void columns_free(log_columns *c)
{
    for (int q = 0; q < QUANTITY_COUNT; q++) {
        free(c->value[q]);
    }
    *c = (log_columns){0};
}

/* The rows of the comparison, collected and as JSON (rows.h). */
#include "rows.h"

#include "base/json_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The places of a row's texts. */
enum { TEXTS = 7 };

static void texts_of(comparison_row *row, const char **text[TEXTS])
{
    const char **const all[TEXTS] = {&row->paper,     &row->item, &row->quantity, &row->method,
                                     &row->condition, &row->unit, &row->note};
    memcpy(text, all, sizeof all);
}

static void free_row(comparison_row *row)
{
    const char **text[TEXTS];
    texts_of(row, text);
    for (int n = 0; n < TEXTS; n++) {
        free((void *)*text[n]);
    }
}

static bool own_texts(comparison_row *row)
{
    bool ok = true;
    const char **text[TEXTS];
    texts_of(row, text);
    for (int n = 0; n < TEXTS; n++) {
        const size_t size = strlen(*text[n]) + 1;
        char *mine = malloc(size);
        ok = ok && mine != NULL;
        *text[n] = mine != NULL ? memcpy(mine, *text[n], size) : NULL;
    }
    return ok;
}

static bool grow(comparison *c)
{
    if (c->count < c->capacity) {
        return true;
    }
    const size_t capacity = c->capacity == 0 ? 64 : 2 * c->capacity;
    comparison_row *row = realloc(c->row, capacity * sizeof *row);
    if (row == NULL) {
        return false;
    }
    c->row = row;
    c->capacity = capacity;
    return true;
}

void comparison_add(comparison *c, comparison_row row)
{
    if (!grow(c)) {
        c->out_of_memory = true;
        return;
    }
    if (!own_texts(&row)) {
        free_row(&row);
        c->out_of_memory = true;
        return;
    }
    c->row[c->count++] = row;
}

bool comparison_check(const comparison *c, error *e)
{
    return !c->out_of_memory || error_failure(e, 0, "comparison: out of memory");
}

void comparison_free(comparison *c)
{
    for (size_t n = 0; n < c->count; n++) {
        free_row(&c->row[n]);
    }
    free(c->row);
    *c = (comparison){0};
}

double comparison_ratio(const comparison_row *row)
{
    return row->value / row->paper_value;
}

int comparison_note(const char *notes[COMPARISON_NOTES], int *count, const char *note)
{
    for (int n = 0; n < *count; n++) {
        if (strcmp(notes[n], note) == 0) {
            return n + 1;
        }
    }
    if (note[0] == '\0' || *count == COMPARISON_NOTES) {
        return 0;
    }
    notes[(*count)++] = note;
    return *count;
}

static json_t *row_json(const comparison_row *r)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:s}", "paper", r->paper, "item", r->item,
                     "quantity", r->quantity, "method", r->method, "condition", r->condition, "unit", r->unit,
                     "paper_value", json_number(r->paper_value), "value", json_number(r->value), "value_iq24",
                     json_number(r->value_iq24), "note", r->note);
}

json_t *comparison_json(const comparison *c)
{
    json_t *rows = json_array();
    json_t *own = json_array();
    bool ok = true;
    for (size_t n = 0; n < c->count; n++) {
        json_t *list = isfinite(c->row[n].paper_value) ? rows : own;
        ok = json_array_append_new(list, row_json(&c->row[n])) == 0 && ok;
    }
    json_t *root = json_pack("{s:o, s:o}", "rows", rows, "own", own);
    if (!ok) {
        json_free(root);
        return NULL;
    }
    return root;
}

/* The comparison as text: one table for each item of a paper, notes numbered below it. */
#include "rows.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 8, CELL = 96, NOTE_WIDTH = 100 };

typedef struct text_row {
    char cell[COLUMNS][CELL];
} text_row;

static const char *const heads[COLUMNS] = {"quantity", "method", "condition", "unit",
                                           "paper",    "double", "IQ24",      "ratio"};
static const bool is_number[COLUMNS] = {false, false, false, false, true, true, true, true};

/* The paper's figures have two or three digits; one more shows the side of the difference. */
static void put_number(char cell[CELL], double value)
{
    if (!isfinite(value)) {
        snprintf(cell, CELL, "-");
    } else if (value != 0.0 && fabs(value) < 1e-3) {
        snprintf(cell, CELL, "%.3e", value);
    } else {
        snprintf(cell, CELL, "%.4g", value);
    }
}

static text_row as_text(const comparison_row *r, int note)
{
    text_row t;
    snprintf(t.cell[0], CELL, "%s", r->quantity);
    snprintf(t.cell[1], CELL, "%s", r->method);
    snprintf(t.cell[2], CELL, "%s", r->condition);
    snprintf(t.cell[3], CELL, "%s", r->unit);
    put_number(t.cell[4], r->paper_value);
    put_number(t.cell[5], r->value);
    put_number(t.cell[6], r->value_iq24);
    const double ratio = comparison_ratio(r);
    char mark[16] = "";
    if (note > 0) {
        snprintf(mark, sizeof mark, " [%d]", note);
    }
    if (isfinite(ratio)) {
        snprintf(t.cell[7], CELL, "%.3f%s", ratio, mark);
    } else {
        snprintf(t.cell[7], CELL, "-%s", mark);
    }
    return t;
}

static void widen(int width[COLUMNS], const text_row *t)
{
    for (int col = 0; col < COLUMNS; col++) {
        const int length = (int)strlen(t->cell[col]);
        width[col] = length > width[col] ? length : width[col];
    }
}

/* The ratio has a column of its own, so that a note after it does not move the numbers. */
static void print_line(FILE *out, const text_row *t, const int width[COLUMNS])
{
    fputs("  ", out);
    for (int col = 0; col < COLUMNS; col++) {
        const bool last = col == COLUMNS - 1;
        if (last) {
            fputs(t->cell[col], out);
        } else if (is_number[col]) {
            fprintf(out, "%*s  ", width[col], t->cell[col]);
        } else {
            fprintf(out, "%-*s  ", width[col], t->cell[col]);
        }
    }
    fputc('\n', out);
}

/* Breaks at spaces. */
static void print_note(FILE *out, int number, const char *note)
{
    int column = fprintf(out, "  [%d]", number);
    const int indent = column;
    while (*note != '\0') {
        const int length = (int)strcspn(note, " ");
        if (column + 1 + length > NOTE_WIDTH) {
            column = fprintf(out, "\n%*s", indent, "") - 1;
        }
        column += fprintf(out, " %.*s", length, note);
        note += length;
        note += strspn(note, " ");
    }
    fputc('\n', out);
}

static bool same_item(const comparison_row *a, const comparison_row *b)
{
    return strcmp(a->paper, b->paper) == 0 && strcmp(a->item, b->item) == 0;
}

static void print_item(const comparison_row *row, size_t count, FILE *out)
{
    const char *notes[COMPARISON_NOTES];
    int note_count = 0;
    int width[COLUMNS];
    text_row head;
    for (int col = 0; col < COLUMNS; col++) {
        snprintf(head.cell[col], CELL, "%s", heads[col]);
        width[col] = 0;
    }
    widen(width, &head);
    for (int pass = 0; pass < 2; pass++) {
        if (pass == 1) {
            fprintf(out, "\n%s, %s\n", row->paper, row->item);
            print_line(out, &head, width);
        }
        for (size_t n = 0; n < count; n++) {
            const text_row t = as_text(&row[n], comparison_note(notes, &note_count, row[n].note));
            if (pass == 0) {
                widen(width, &t);
            } else {
                print_line(out, &t, width);
            }
        }
    }
    for (int n = 0; n < note_count; n++) {
        print_note(out, n + 1, notes[n]);
    }
}

void comparison_print(const comparison *c, FILE *out)
{
    size_t start = 0;
    while (start < c->count) {
        size_t end = start + 1;
        while (end < c->count && same_item(&c->row[start], &c->row[end])) {
            end++;
        }
        print_item(&c->row[start], end - start, out);
        start = end;
    }
}

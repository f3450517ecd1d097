/* The meaning of a character depends on its position in a field (csv_quoted.h). */
#include "csv_quoted.h"

#include <stdlib.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool is_line_end(char c)
{
    return c == '\n' || c == '\r';
}

/* A field is never longer than what was fed since its start, so that this much is asked for at once. */
static bool make_room(csv_quoted *q, size_t more)
{
    const size_t need = q->length + more;
    if (need <= q->size) {
        return true;
    }
    char *grown = realloc(q->field, 2 * need);
    if (grown == NULL) {
        return false;
    }
    q->field = grown;
    q->size = 2 * need;
    return true;
}

static void end_field(csv_quoted *q)
{
    q->on_field(q->context, q->field, q->length - q->blanks);
    q->length = 0;
    q->blanks = 0;
    q->state = CSV_BEFORE_FIELD;
}

static void end_record(csv_quoted *q)
{
    end_field(q);
    q->on_record(q->context);
    q->state = CSV_BEFORE_RECORD;
}

static void keep(csv_quoted *q, char c, csv_quoted_state state)
{
    q->field[q->length++] = c;
    q->state = state;
}

/* Outside quotes, and not right behind one. False for a quote where none may stand. */
static bool take_bare(csv_quoted *q, char c)
{
    if (c == '"') {
        const bool opens = q->state != CSV_IN_FIELD;
        q->state = CSV_IN_QUOTES;
        return opens;
    }
    if (c == ',') {
        end_field(q);
    } else if (is_line_end(c)) {
        if (q->state != CSV_BEFORE_RECORD) {
            end_record(q);
        }
    } else if (!is_blank(c)) {
        q->blanks = 0;
        keep(q, c, CSV_IN_FIELD);
    } else if (q->state == CSV_IN_FIELD) {
        q->blanks++;
        keep(q, c, CSV_IN_FIELD);
    }
    return true;
}

/* Behind a quote that closed, or the first of a doubled one. */
static bool take_after_quote(csv_quoted *q, char c)
{
    if (c == '"' && q->blanks == 0) {
        keep(q, c, CSV_IN_QUOTES);
    } else if (c == ',') {
        end_field(q);
    } else if (is_line_end(c)) {
        end_record(q);
    } else if (is_blank(c)) {
        q->blanks++;
        keep(q, c, CSV_AFTER_QUOTE);
    } else {
        return false;
    }
    return true;
}

csv_quoted_result csv_quoted_feed(csv_quoted *q, const char *text, size_t length)
{
    if (!make_room(q, length)) {
        return CSV_QUOTED_NO_MEMORY;
    }
    for (size_t k = 0; k < length; k++) {
        const char c = text[k];
        bool fits = true;
        if (q->state == CSV_AFTER_QUOTE) {
            fits = take_after_quote(q, c);
        } else if (q->state != CSV_IN_QUOTES) {
            fits = take_bare(q, c);
        } else if (c == '"') {
            q->state = CSV_AFTER_QUOTE;
        } else {
            keep(q, c, CSV_IN_QUOTES);
        }
        if (!fits) {
            return CSV_QUOTED_STRAY;
        }
    }
    return CSV_QUOTED_OK;
}

bool csv_quoted_end(csv_quoted *q)
{
    if (q->state == CSV_IN_QUOTES) {
        return false;
    }
    if (q->state != CSV_BEFORE_RECORD) {
        end_record(q);
    }
    return true;
}

void csv_quoted_free(csv_quoted *q)
{
    free(q->field);
    *q = (csv_quoted){0};
}

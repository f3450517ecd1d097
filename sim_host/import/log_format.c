#include "log_format.h"

#include "base/number.h"
#include "data/foreign_names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool ends_field(char c, char delimiter)
{
    return delimiter == ' ' ? is_blank(c) : c == delimiter;
}

/* A quoted field from line[at] on, unquoted in place; the place behind its closing quote, or 0 without one. */
static size_t take_quoted(char *line, size_t length, size_t offset, log_field *f)
{
    char *to = line + offset;
    f->text = to;
    for (size_t from = offset + 1; from < length; from++) {
        if (line[from] != '"') {
            *to++ = line[from];
        } else if (from + 1 < length && line[from + 1] == '"') {
            *to++ = line[from++];
        } else {
            f->length = (size_t)(to - f->text);
            return from + 1;
        }
    }
    return 0;
}

static void trim(log_field *f)
{
    while (f->length > 0 && is_blank(f->text[0])) {
        f->text++;
        f->length--;
    }
    while (f->length > 0 && is_blank(f->text[f->length - 1])) {
        f->length--;
    }
}

int log_line_split(char *line, size_t length, char delimiter, log_field *fields)
{
    int count = 0;
    size_t offset = 0;
    while (length > 0 && delimiter == ' ' && is_blank(line[length - 1])) {
        length--;
    }
    for (;;) {
        while (offset < length && is_blank(line[offset]) &&
               line[offset] != delimiter + (delimiter == ' ' ? 1 : 0)) {
            offset++;
        }
        if (count == LOG_FIELDS_MOST) {
            return -2;
        }
        log_field *f = &fields[count++];
        *f = (log_field){line + offset, 0, offset};
        if (offset < length && line[offset] == '"') {
            offset = take_quoted(line, length, offset, f);
            if (offset == 0) {
                return -1;
            }
            while (offset < length && !ends_field(line[offset], delimiter)) {
                offset++; /* text behind a closing quote belongs to nothing */
            }
        } else {
            while (offset < length && !ends_field(line[offset], delimiter)) {
                offset++;
            }
            f->length = (size_t)(line + offset - f->text);
        }
        trim(f);
        if (offset >= length) {
            return count;
        }
        offset++;
    }
}

bool log_field_number(const log_field *f, char decimal, double *value)
{
    char text[64];
    if (f->length == 0 || f->length >= sizeof text) {
        return false;
    }
    for (size_t k = 0; k < f->length; k++) {
        if (decimal == ',' && f->text[k] == '.') {
            return false;
        }
        text[k] = decimal == ',' && f->text[k] == ',' ? '.' : f->text[k];
    }
    return number_parse(text, f->length, value) == NUMBER_OK;
}

/* What a line is under a delimiter and a decimal mark. */
typedef struct line_kind {
    int fields, numbers, filled;
    bool is_row; /* two numbers or more, and half of what is filled in */
} line_kind;

static bool look(const log_head *head, size_t k, char delimiter, char decimal, char *copy, log_field *fields,
                 line_kind *kind)
{
    *kind = (line_kind){0};
    memcpy(copy, head->line[k], head->length[k]);
    kind->fields = log_line_split(copy, head->length[k], delimiter, fields);
    if (kind->fields < 1) {
        return false;
    }
    for (int n = 0; n < kind->fields; n++) {
        double value;
        kind->filled += fields[n].length > 0 ? 1 : 0;
        kind->numbers += log_field_number(&fields[n], decimal, &value) ? 1 : 0;
    }
    kind->is_row = kind->numbers >= 2 && 2 * kind->numbers >= kind->filled;
    return true;
}

/* A unit row has no number and names units only: "s", "[A]", "(rad/s)", "-", or nothing. */
static bool is_unit(const log_field *f)
{
    const bool is_none = f->length == 0 || (f->length == 1 && strchr("-1", f->text[0]) != NULL);
    return is_none || foreign_unit_find(f->text, f->length) != NULL;
}

typedef struct finder {
    log_format *format;
    log_head *head;
    char *copy;
    log_field *fields;
} finder;

/* Numbers minus fields that are none, over the lines that are rows. */
static long score(const finder *f, char delimiter, char decimal)
{
    long sum = 0;
    for (size_t k = 0; k < f->head->lines; k++) {
        line_kind kind;
        if (look(f->head, k, delimiter, decimal, f->copy, f->fields, &kind) && kind.is_row) {
            sum += 2 * kind.numbers - kind.filled;
        }
    }
    return sum;
}

static bool find_marks(const finder *f)
{
    static const char delimiters[] = {';', '\t', ',', ' '};
    long best = 0;
    char delimiter = 0;
    char decimal = 0;
    for (size_t d = 0; d < sizeof delimiters; d++) {
        for (int comma = 0; comma < 2; comma++) {
            const char mark = comma ? ',' : '.';
            if ((f->format->delimiter != 0 && f->format->delimiter != delimiters[d]) ||
                (f->format->decimal != 0 && f->format->decimal != mark)) {
                continue;
            }
            const long found = score(f, delimiters[d], mark);
            if (found > best) {
                best = found;
                delimiter = delimiters[d];
                decimal = mark;
            }
        }
    }
    f->format->delimiter = delimiter;
    f->format->decimal = decimal;
    return best > 0;
}

static bool is_units(const finder *f, size_t k)
{
    line_kind kind;
    look(f->head, k, f->format->delimiter, f->format->decimal, f->copy, f->fields, &kind);
    int units = 0;
    for (int n = 0; n < kind.fields; n++) {
        if (!is_unit(&f->fields[n])) {
            return false;
        }
        units += f->fields[n].length > 0 ? 1 : 0;
    }
    return units > 0;
}

/* The header is the last line ahead of the rows with as many fields; a unit row may follow it. */
static void find_header(const finder *f)
{
    log_head *head = f->head;
    line_kind row = {0};
    head->first_row = head->lines;
    const size_t from = f->format->skip >= 0 ? (size_t)f->format->skip : 0;
    for (size_t k = from; k < head->lines && head->first_row == head->lines; k++) {
        if (look(head, k, f->format->delimiter, f->format->decimal, f->copy, f->fields, &row) && row.is_row) {
            head->first_row = k;
        }
    }
    for (size_t k = head->first_row; k-- > from && !head->has_header;) {
        line_kind kind;
        const bool whole = look(head, k, f->format->delimiter, f->format->decimal, f->copy, f->fields, &kind);
        if (!whole || kind.fields < 2 || abs(kind.fields - row.fields) > 1 || kind.numbers > 0) {
            continue;
        }
        if (!head->has_units && is_units(f, k) && k > from) {
            head->has_units = true;
            head->units = k;
        } else {
            head->has_header = true;
            head->header = k;
        }
    }
    if (!head->has_header && head->has_units) {
        head->has_units = false;
        head->has_header = true;
        head->header = head->units;
    }
}

bool log_format_find(log_format *format, log_head *head, const char *path, error *e)
{
    size_t longest = 1;
    for (size_t k = 0; k < head->lines; k++) {
        longest = head->length[k] > longest ? head->length[k] : longest;
    }
    finder f = {format, head, malloc(longest), malloc(LOG_FIELDS_MOST * sizeof(log_field))};
    bool ok = f.copy != NULL && f.fields != NULL;
    if (!ok) {
        error_failure(e, 0, "%s: out of memory", path);
    } else if (format->skip >= (long)head->lines) {
        ok = error_input(e, path, 0, 0, "[format] skip = %ld leaves nothing of the first %zu lines",
                         format->skip, head->lines);
    } else if (!find_marks(&f)) {
        ok = error_input(e, path, head->lines > 0 ? 1 : 0, 0,
                         head->lines == 0
                             ? "the log is empty; expected a header row and rows of numbers"
                             : "no rows of numbers are found here with any delimiter; [format] of "
                               "a map can say delimiter, decimal, encoding and skip");
    } else {
        find_header(&f);
        if (head->first_row == head->lines) {
            ok = error_input(e, path, (long)head->lines, 0, "no rows of numbers follow");
        }
    }
    free(f.copy);
    free(f.fields);
    return ok;
}

/* JSON as text: numbers, indentation, and the file around it (json_file.h). */
#include "json_file.h"

#include "number.h"
#include "out_file.h"

#include <math.h>
#include <string.h>

enum { INDENT = 2 };

static void put_indent(FILE *out, int depth)
{
    fprintf(out, "\n%*s", depth * INDENT, "");
}

static void put_real(FILE *out, double value)
{
    char text[NUMBER_TEXT_SIZE];
    number_text(value, text);
    fputs(text, out);
    /* A real stays one for readers that tell 5 from 5.0. */
    if (strpbrk(text, ".e") == NULL) {
        fputs(".0", out);
    }
}

/* True for an array short enough in kind to read on one line: [4.11, 4.25]. */
static bool is_flat(const json_t *array)
{
    bool flat = true;
    for (size_t i = 0; flat && i < json_array_size(array); i++) {
        const json_t *value = json_array_get(array, i);
        flat = !json_is_object(value) && !json_is_array(value);
    }
    return flat;
}

static bool put_value(FILE *out, const json_t *value, int depth);

static bool put_array(FILE *out, const json_t *array, int depth)
{
    const bool flat = is_flat(array);
    bool ok = true;
    fputc('[', out);
    for (size_t i = 0; i < json_array_size(array); i++) {
        if (i > 0) {
            fputs(flat ? ", " : ",", out);
        }
        if (!flat) {
            put_indent(out, depth + 1);
        }
        ok = put_value(out, json_array_get(array, i), depth + 1) && ok;
    }
    if (!flat) {
        put_indent(out, depth);
    }
    fputc(']', out);
    return ok;
}

/* jansson knows how to escape text; it is asked for that alone. */
static bool put_text(FILE *out, const char *text)
{
    json_t *string = json_string(text);
    const bool ok = string != NULL && json_dumpf(string, out, JSON_ENCODE_ANY) == 0;
    json_decref(string);
    return ok;
}

static bool put_object(FILE *out, const json_t *object, int depth)
{
    bool ok = true;
    bool first = true;
    const char *key;
    json_t *value;
    fputc('{', out);
    /* The iteration macros want a non-const object but change nothing. */
    json_object_foreach((json_t *)object, key, value)
    {
        fputs(first ? "" : ",", out);
        first = false;
        put_indent(out, depth + 1);
        ok = put_text(out, key) && ok;
        fputs(": ", out);
        ok = put_value(out, value, depth + 1) && ok;
    }
    if (!first) {
        put_indent(out, depth);
    }
    fputc('}', out);
    return ok;
}

static bool put_value(FILE *out, const json_t *value, int depth)
{
    if (json_is_object(value)) {
        return put_object(out, value, depth);
    }
    if (json_is_array(value)) {
        return put_array(out, value, depth);
    }
    if (json_is_real(value)) {
        put_real(out, json_real_value(value));
        return true;
    }
    return json_dumpf(value, out, JSON_ENCODE_ANY) == 0;
}

bool json_file_write(const char *path, const json_t *value, error *e)
{
    if (value == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    const bool complete = put_value(f.stream, value, 0);
    fputc('\n', f.stream);
    if (!complete) {
        out_file_abandon(&f);
        return error_failure(e, 0, "%s: out of memory", path);
    }
    return out_file_commit(&f, e);
}

bool json_file_place(out_folder *f, const char *path, json_t *value, error *e)
{
    const char *place = path != NULL ? out_folder_place(f, path, e) : NULL;
    const bool ok = path == NULL || (place != NULL && json_file_write(place, value, e));
    json_decref(value);
    return ok;
}

bool json_file_is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

json_t *json_number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

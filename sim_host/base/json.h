/*
 * JSON values: built, read, looked into, printed. By nlohmann's JSON for Modern C++ (json.cpp), in the words of C.
 *
 * Objects keep the order of their keys. Each real is printed as the shortest text that reads back to the same double
 * (number.h); an array of plain values stays on one line.
 *
 * Who makes a value owns it, until he gives it into another; what is got out of a value belongs to that, and is good until
 * something is added to that. NULL stands for a value that could not be made: it may be given to any function here, and what
 * is made with it is NULL too. Memory running out ends the program.
 */
#ifndef SIM_HOST_BASE_JSON_H
#define SIM_HOST_BASE_JSON_H

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct json_t json_t;
typedef long long json_int_t;

/* ---- Made ---- */

json_t *json_object(void);
json_t *json_array(void);
json_t *json_boolean(bool value);
json_t *json_null(void);
json_t *json_integer(json_int_t value);

/* NULL for NaN and infinities, which JSON has not. */
json_t *json_real(double value);

/* A real; null where x is not finite. */
json_t *json_number(double x);

/* What is not UTF-8 in the text becomes U+FFFD. NULL for a text of NULL. */
json_t *json_string(const char *text);

/*
 * A whole tree by its form: { } and [ ] with, for each value,
 *     s text (const char *)     i int     I json_int_t     f double     b truth as int     n null
 *     o a json_t * that is given away; "o*": left out with its key where it is NULL
 * and each key as s, ahead of its value. Spaces, commas and colons are for the reader. NULL where a part is NULL; all that
 * was given is then freed.
 */
json_t *json_pack(const char *form, ...);

/* Gives `value` away, also where it fails: 0, or -1 if either is NULL or not of that kind. A key that is there is replaced. */
int json_array_append_new(json_t *array, json_t *value);
int json_object_set_new(json_t *object, const char *key, json_t *value);

/* The array with `value` at its end. NULL if either is NULL or it is no array; both are freed then: list = json_appended(list, value). */
json_t *json_appended(json_t *array, json_t *value);

/* Copies all members of `more` into `object`: 0, or -1. */
int json_object_update(json_t *object, const json_t *more);

void json_free(json_t *value);

/* ---- Read ---- */

typedef struct json_complaint {
    long line; /* 0: of no line */
    char text[200];
    error
        file; /* set if the file was refused (inputs.h) or memory ran out: the whole message, in place of `text` */
} json_complaint;

/* A file of at most 64 MiB. NULL with the complaint. */
json_t *json_read(const char *path, json_complaint *wrong);

/* ---- Looked into; of a value that is missing or of another kind: NULL, 0, false ---- */

json_t *json_object_get(const json_t *object, const char *key);
json_t *json_array_get(const json_t *array, size_t index);
size_t json_array_size(const json_t *array);
bool json_is_object(const json_t *value);
bool json_is_array(const json_t *value);
bool json_is_string(const json_t *value);
bool json_is_number(const json_t *value); /* integer or real */
bool json_is_true(const json_t *value);
bool json_is_null(const json_t *value);
double json_number_value(const json_t *value);
const char *json_string_value(const json_t *value);
bool json_equal(const json_t *a, const json_t *b);

/* ---- Printed, without a newline at the end; an error shows in the stream ---- */

void json_print(FILE *out, const json_t *value);

#ifdef __cplusplus
}
#endif

#endif

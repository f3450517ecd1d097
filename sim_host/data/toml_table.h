/*
 * Reads TOML files through a C interface; every error has line and column.
 *
 * A reader asks for every key it knows; each question carries the range that makes sense. The first thing
 * found wrong goes into the file's `error` and stays (error.h), later questions answer their default, so that
 * a reader is a plain list of assignments with one check at its end: toml_file_close(). That also refuses
 * every key that nobody asked for, with the nearest key that somebody did ask for as a suggestion. The keys a
 * file may hold are thus written down once, where they are read.
 *
 * Positions are those of the value where there is one, of the key where it is unknown, and of its table's
 * header where it is missing. Implemented over toml++ (toml_table.cpp).
 */
#ifndef SIM_HOST_DATA_TOML_TABLE_H
#define SIM_HOST_DATA_TOML_TABLE_H

#include "../base/error.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct toml_file toml_file;
typedef struct toml_table toml_table; /* lives as long as its file; NULL is a table that is absent */

/* What a number may be. NaN and infinities never are. */
typedef struct toml_range {
    double min, max;
    bool min_open; /* min itself is refused: "> 0" */
} toml_range;

extern const toml_range TOML_ANY;          /* finite */
extern const toml_range TOML_POSITIVE;     /* > 0 */
extern const toml_range TOML_NOT_NEGATIVE; /* >= 0 */

/* Parses; NULL with *e set if the file cannot be read or is no TOML. `e` is where all later errors go. */
toml_file *toml_file_open(const char *path, error *e);

/* Refuses keys that nobody asked for, frees; true if no error was met since opening. NULL is an error met. */
bool toml_file_close(toml_file *file);

toml_table *toml_file_root(toml_file *file);

/* A table within a table. The _or_null form may be absent; the other refuses that. */
toml_table *toml_table_inner(toml_table *table, const char *key);
toml_table *toml_table_inner_or_null(toml_table *table, const char *key);

/* [[key]]: how many there are (0 if none), and each. */
size_t toml_table_count(toml_table *table, const char *key);
toml_table *toml_table_at(toml_table *table, const char *key, size_t index);

/* Is the key there? Asking makes it a known key. */
bool toml_has(toml_table *table, const char *key);
bool toml_is_table(toml_table *table, const char *key);

/* Numbers; an integer is accepted as a real. The _or forms return `absent` when the key is. */
double toml_number(toml_table *table, const char *key, toml_range range);
double toml_number_or(toml_table *table, const char *key, toml_range range, double absent);
long toml_integer(toml_table *table, const char *key, long min, long max);
long toml_integer_or(toml_table *table, const char *key, long min, long max, long absent);

/* An array of numbers, or one number; returns how many came into values[max], 0 when the key is absent. */
size_t toml_numbers(toml_table *table, const char *key, toml_range range, double *values, size_t max);

/* An array of pairs of a name and one of `count` words: how many there are, 0 if none; and each, its name in text[size] and the
 * index of its word. */
size_t toml_pairs(toml_table *table, const char *key);
size_t toml_pair_at(toml_table *table, const char *key, size_t index, char *text, size_t size,
                    const char *const *words, size_t count);

bool toml_flag_or(toml_table *table, const char *key, bool absent);

/* Text of at least 1 and less than `size` bytes into text[size]; the absent form leaves `text` as it is. */
void toml_text_or_keep(toml_table *table, const char *key, char *text, size_t size);

/* One of `count` words: its index. Any other word is refused with the list. */
size_t toml_choice_or(toml_table *table, const char *key, const char *const *words, size_t count,
                      size_t absent);

/* Line and column of a key's value; false if it is absent. */
bool toml_position(toml_table *table, const char *key, long *line, long *column);

/* An error at a key's value, or its table if it is absent: for checks of several keys. Returns false. */
bool toml_refuse(toml_table *table, const char *key, const char *format, ...) ERROR_PRINTF(3, 4);

#ifdef __cplusplus
}
#endif

#endif

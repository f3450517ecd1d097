/*
 * A log of packed binary rows as a table: what firmware sends over a serial line or writes to a card.
 *
 * Each row is the same list of numbers without gaps, the first byte the least (little endian), or with `big_endian` the highest.
 *
 *     frame = "fixed"   rows follow one another; a last row that the log's end cuts is left out
 *     frame = "slip"    RFC 1055: each row ends with 0xC0 (and may begin with one); 0xDB 0xDC in it means 0xC0, 0xDB 0xDD means 0xDB.
 *                       The first and the last frame may be cut; any other that has not a row's length is refused.
 */
#ifndef SIM_HOST_IMPORT_LOG_BINARY_H
#define SIM_HOST_IMPORT_LOG_BINARY_H

#include "log_table.h"

enum { BINARY_FIELDS_MOST = 256, BINARY_NAME_SIZE = 64 };

typedef enum binary_kind {
    BINARY_U8,
    BINARY_I8,
    BINARY_U16,
    BINARY_I16,
    BINARY_U32,
    BINARY_I32,
    BINARY_F32,
    BINARY_F64,
    BINARY_KINDS
} binary_kind;

/* "u8" ... as a map spells them. */
extern const char *const binary_kind_words[BINARY_KINDS];

typedef struct binary_field {
    char name[BINARY_NAME_SIZE];
    binary_kind kind;
} binary_field;

typedef struct binary_format {
    size_t fields; /* 0: the log is text */
    binary_field field[BINARY_FIELDS_MOST];
    bool slip, big_endian;
    long skip; /* bytes ahead of the first row */
} binary_format;

/* Reads all of the log, plain or gzip, "-" is stdin, as a table whose columns are the fields. False with *e set. */
bool log_binary_open(log_table *t, const char *path, const binary_format *format, error *e);

#endif

/*
 * A small text file, whole.
 */
#ifndef SIM_HOST_BASE_TEXT_FILE_H
#define SIM_HOST_BASE_TEXT_FILE_H

#include "error.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Its bytes with a 0 after them, *length without it; free() them. NULL with *e set if the file cannot be read
 * or is larger than `largest` bytes; `expected` says in that line what should have been there: "a TOML file".
 */
char *text_file_read(const char *path, size_t largest, const char *expected, size_t *length, error *e);

#ifdef __cplusplus
}
#endif

#endif

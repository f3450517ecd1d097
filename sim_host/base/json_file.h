/*
 * A jansson value as a file that appears whole or not at all (out_file.h).
 *
 * jansson itself prints 0.1 as 0.10000000000000001; here every real gets the shortest text that reads back to
 * the same double. Objects keep the order of their keys; an array of plain values stays on one line.
 */
#ifndef SIM_HOST_BASE_JSON_FILE_H
#define SIM_HOST_BASE_JSON_FILE_H

#include "out_folder.h"

#include <jansson.h>

/* Writes with a newline at the end; "-" is stdout. Keeps no reference. NULL: out of memory while building. */
bool json_file_write(const char *path, const json_t *value, error *e);

/*
 * The same for a file that the user named beside an output folder (out_folder_place). A path of NULL: nothing
 * is to be written. Takes the reference.
 */
bool json_file_place(out_folder *f, const char *path, json_t *value, error *e);

/* Is the JSON to stand on stdout, and so nothing else? The path may be NULL. */
bool json_file_is_stdout(const char *path);

/* A real; null where x is not finite. */
json_t *json_number(double x);

#endif

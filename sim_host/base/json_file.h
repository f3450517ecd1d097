/* A JSON value (json.h) as a file that appears whole or not at all (out_file.h). */
#ifndef SIM_HOST_BASE_JSON_FILE_H
#define SIM_HOST_BASE_JSON_FILE_H

#include "json.h"
#include "out_folder.h"

/* Writes with a newline at the end; "-" is stdout. The value stays the caller's. NULL: one that could not be made. */
bool json_file_write(const char *path, const json_t *value, error *e);

/*
 * The same for a file that is given in addition to an output folder (out_folder_place). A path of NULL: nothing
 * is to be written. Frees the value.
 */
bool json_file_place(out_folder *f, const char *path, json_t *value, error *e);

/* True if the JSON goes to stdout, which then holds nothing else. The path may be NULL. */
bool json_file_is_stdout(const char *path);

#endif

/*
 * Output files that appear whole or not at all: written under a hidden name in the same directory (out_unfinished.h), flushed, and
 * renamed over the old file only when everything was written. The old file stays until then. A file in the stage of an output folder
 * has its name at once and appears with the others (out_folder.h).
 */
#ifndef SIM_HOST_BASE_OUT_FILE_H
#define SIM_HOST_BASE_OUT_FILE_H

#include "error.h"
#include "out_unfinished.h"

#include <stdio.h>

typedef struct out_file {
    FILE *stream;        /* NULL when nothing is open */
    char path[OUT_PATH]; /* the final name */
    out_unfinished
        temporary; /* the name while it is written; none for stdout, devices and files in a stage */
} out_file;

/* Opens for writing. "-" is stdout. False with *e set when the directory is missing or not writable. */
bool out_file_open(out_file *f, const char *path, error *e);

/* Flushes, checks every write, renames. On failure removes the temporary file and sets *e. */
bool out_file_commit(out_file *f, error *e);

/* Forgets it: removes the temporary file. Safe after commit and on a zeroed struct. */
void out_file_abandon(out_file *f);

#endif

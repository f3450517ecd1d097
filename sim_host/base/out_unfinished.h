/*
 * Hidden names for unfinished files and folders: `.iqfoc.PID-N` in the directory of the finished one. The writing process holds a lock on the name; the system releases the lock when the process ends for any reason. A name without a lock was left by a killed process (kill -9), and the next process that writes in that directory removes it. Where a file system knows no locks nothing is removed.
 */
#ifndef SIM_HOST_BASE_OUT_UNFINISHED_H
#define SIM_HOST_BASE_OUT_UNFINISHED_H

#include <stdbool.h>
#include <stddef.h>

/* What ends the name of a folder whose files are on their way into place (out_folder_files.c). */
#define OUT_UNFINISHED_WHOLE ".whole"

typedef struct out_unfinished {
    char *path;     /* NULL: none */
    int descriptor; /* of the file or folder, whose closing ends the lock; -1: none */
} out_unfinished;

/*
 * Makes an empty file (mode 0600) or a folder next to `path`, in the directory that its text up to the last slash names; removes
 * what was left there. Returns 0 or an errno, with `path` NULL then.
 */
int out_unfinished_make(out_unfinished *u, const char *path, bool folder);

/* The lock goes; what bore the name is elsewhere by now, or removed. Safe on a zeroed struct. */
void out_unfinished_end(out_unfinished *u);

/*
 * Of a directory's entry by this name, a descriptor that holds its lock, if it is a folder of ours that ends in `suffix` and has been
 * left; else -1.
 */
int out_unfinished_left(int directory, const char *name, const char *suffix);

/* Removes the files of an open folder; takes the descriptor. */
void out_unfinished_empty(int folder);

#endif

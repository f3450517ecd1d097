/*
 * Hidden names for unfinished files and folders: `.iqfoc.PID-N` in the directory of the finished one. The writing process holds a
 * lock on the name; the system releases the lock when the process ends for any reason. A name without a lock was left by a killed
 * process (kill -9), and the next process that writes in that directory removes it. A signal that ends the process removes the name
 * at once (leftovers.h). Where a file system knows no locks nothing is removed.
 */
#ifndef SIM_HOST_BASE_OUT_UNFINISHED_H
#define SIM_HOST_BASE_OUT_UNFINISHED_H

#include <stdbool.h>
#include <sys/types.h>

enum { OUT_PATH = 4096 /* bytes of a path, as the system takes it */ };

typedef struct out_unfinished {
    char path[OUT_PATH]; /* "": none */
    int descriptor;      /* of the file or folder; closing it ends the lock; -1: none, or owned by a stream */
} out_unfinished;

/*
 * Makes an empty file with this mode, or a folder if the mode has S_IFDIR, in the directory that the text of `path` up to its last
 * slash names; first removes what was left there. Returns 0 or an errno, with an empty `u->path` then.
 */
int out_unfinished_make(out_unfinished *u, const char *path, mode_t mode);

/* Releases the lock; the file or folder has its final name by now, or is removed here with the files in it. Safe on a zeroed struct. */
void out_unfinished_end(out_unfinished *u, bool remove);

/* Is the file in an unfinished folder, with which it appears or goes? */
bool out_unfinished_holds(const char *path);

/* A descriptor that holds the lock of a directory's entry if the name is one of these, ends in `suffix` and has been left; else -1. */
int out_unfinished_left(int directory, const char *name, const char *suffix);

/* Removes a file, or a folder with the files in it. */
void out_unfinished_remove(int directory, const char *name);

#endif

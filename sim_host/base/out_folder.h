/*
 * An output folder that appears whole or not at all.
 *
 *     out_folder f;
 *     const bool ok = out_folder_open(&f, directory, e) && write_files(f.stage, e);
 *     return out_folder_close(&f, ok, e);
 *
 * The files are written into a hidden folder in the same file system, the stage, and put in place when all of
 * them are there. A folder that did not exist appears by one rename. In one that exists, the files that were
 * written replace those of the same name, one after the other and all of them or none; whatever else is in it
 * stays as it is. Two programs that write into one folder at once leave the files of the one or the other,
 * never some of each. After a failure, and after a signal that ends the process, the folder is as it was.
 * What a process that was killed (kill -9) has left the next one removes; if that was among the renames, the
 * next one does the rest of them first.
 *
 * What is written into the stage: plain files, by out_file.h, no folders.
 */
#ifndef SIM_HOST_BASE_OUT_FOLDER_H
#define SIM_HOST_BASE_OUT_FOLDER_H

#include "error.h"
#include "out_unfinished.h"

#include <stddef.h>

enum {
    OUT_FOLDER_LONGEST = 900 /* of a path: a file's in its stage then fits in 1000 */
};

typedef struct out_folder {
    char path[OUT_FOLDER_LONGEST +
              1];          /* as the user named it, without a slash at its end; "": nothing is open */
    const char *stage;     /* the folder to write into; for no message and no page */
    char placed[OUT_PATH]; /* what out_folder_place gave last */
    size_t there;          /* length of the part of `path` that existed before */
    out_unfinished own;    /* the stage's name and lock */
} out_folder;

/*
 * Makes the stage. False with *e set when the path is no directory or nothing can be written there. True with a path of NULL, which
 * opens nothing.
 */
bool out_folder_open(out_folder *f, const char *path, error *e);

/*
 * The same for files that the user named one by one, each a path, "-" or NULL: the folder of the first that is to be
 * a plain file, so that what is named in it appears together, and not at all if another cannot be written. Nothing is
 * opened for one file alone, nor for a folder that there is not: who writes the file then says so.
 */
bool out_folder_open_for(out_folder *f, const char *const paths[], size_t count, error *e);

/*
 * Where to write a file that the user named separately: in the stage if `path` lies in the folder, so that
 * `-o DIR --json DIR/x.json` goes with the others; else `path` itself, as when nothing is open, and for what is a
 * pipe or a device. Valid until the next call and until the folder is closed. NULL with *e set when the path is too long.
 */
const char *out_folder_place(out_folder *f, const char *path, error *e);

/*
 * Puts the files in place if `ok`, with the parents of the folder where they are missing; else removes them, and *e then names the
 * user's path instead of the stage's. Returns whether the files are in place, and `ok` itself if nothing is open, as after an opening
 * that failed. Nothing is open afterwards.
 */
bool out_folder_close(out_folder *f, bool ok, error *e);

#endif

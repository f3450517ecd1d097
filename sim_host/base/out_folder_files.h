/* The files of an output folder, from the stage to their place (out_folder.h). */
#ifndef SIM_HOST_BASE_OUT_FOLDER_FILES_H
#define SIM_HOST_BASE_OUT_FOLDER_FILES_H

#include "error.h"
#include "out_unfinished.h"

/*
 * Puts the stage's files into `path`: by renaming the stage if there is no such folder, else file by file
 * under a lock, the stage's name then saying that it is whole. False with *e set and `path` as it was when a
 * file has no place there or cannot be written.
 */
bool out_folder_put(out_unfinished *stage, const char *path, error *e);

/* Removes the stage with what is left in it. */
void out_folder_remove(const char *stage);

#endif

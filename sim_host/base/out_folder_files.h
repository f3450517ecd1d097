/* The files of an output folder, from the stage to their place in a folder that exists (out_folder.h). */
#ifndef SIM_HOST_BASE_OUT_FOLDER_FILES_H
#define SIM_HOST_BASE_OUT_FOLDER_FILES_H

#include "error.h"
#include "out_unfinished.h"

/*
 * Moves the stage's files into the folder `path` one by one, under a lock; the stage's name then says that it is whole. False with *e
 * set and the folder as it was when a file has no place there or cannot be written.
 */
bool out_folder_replace_files(out_unfinished *stage, const char *path, error *e);

#endif

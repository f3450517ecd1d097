/*
 * The files that this run of the program reads, so that none of them is overwritten.
 *
 * Every reader notes what it opens. Every writer asks, once before it begins and once before its file takes the name.
 * A command reserves the outputs that the user named. A reader that opens one of them is refused, before any work.
 * Two names are one file if device and inode are the same: a path written differently, a symbolic link or a second
 * hard link does not hide an input. The program's main function switches this on; a library in somebody else's
 * process (Python, a browser, an FMU) reads and writes the same file in two calls as its caller likes.
 */
#ifndef SIM_HOST_BASE_INPUTS_H
#define SIM_HOST_BASE_INPUTS_H

#include "error.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* From now on inputs are noted. */
void inputs_watch(void);

/*
 * Reserves `path` for an output of this command, whether or not it names a file yet; - is standard output and no
 * file. False with *e set when memory runs out.
 */
bool inputs_reserve(const char *path, error *e);

/*
 * Notes an open file that is being read; `path` for the message. False with *e set if it is a reserved output, and
 * when memory runs out.
 */
bool inputs_note(int descriptor, const char *path, error *e);

/* False with *e set where `path` names a file that has been noted. A path that names nothing is free. */
bool inputs_spare(const char *path, error *e);

#ifdef __cplusplus
}
#endif

#endif

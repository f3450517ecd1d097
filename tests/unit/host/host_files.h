/*
 * For the tests of file readers and writers: a scratch directory, and files in it by content.
 */
#ifndef TESTS_UNIT_HOST_FILES_H
#define TESTS_UNIT_HOST_FILES_H

#include <stddef.h>

/* Makes a scratch directory and returns its path; the whole run of a test program uses one. */
const char *scratch_begin(void);

/* Removes it with all that is in it. */
void scratch_end(void);

/* The path of a name in the scratch directory. Valid until the fourth call after this one. */
const char *scratch_path(const char *name);

/* Writes a file there; returns its path. */
const char *scratch_file(const char *name, const void *bytes, size_t length);
const char *scratch_text(const char *name, const char *text);

/* The whole file as text, NULL if it does not exist; free() it. */
char *scratch_read(const char *name);

/* How many files there are: a temporary file left behind shows here. */
size_t scratch_count(void);

#endif

/*
 * Several recordings in one call of iqfoc diagnose: one process each, as many at a time as the machine has
 * cores, and a summary at the end. Nothing is shared between them, so that a job scheduler can just as well
 * run them one by one.
 */
#ifndef SIM_HOST_COMMANDS_DIAGNOSE_MANY_H
#define SIM_HOST_COMMANDS_DIAGNOSE_MANY_H

#include "base/error.h"

#include <stdbool.h>

/* Diagnoses one recording into a directory, in a process of its own; its words go to the standard output. */
typedef bool diagnose_one(const void *request, const char *recording_path, const char *directory, error *e);

/*
 * Each recording's results go to DIRECTORY/<its file name without .csv or .csv.gz>/, the summary to
 * DIRECTORY/summary.json and, as a table, to the standard output. *status becomes the worst of the single
 * ones. False with *e set if the summary itself fails or two recordings have one name.
 */
bool diagnose_many(diagnose_one *one, const void *request, char *const recordings[], int n,
                   const char *directory, int *status, error *e);

#endif

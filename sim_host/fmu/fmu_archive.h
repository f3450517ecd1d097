/* The ZIP archive that an FMU is, over minizip: written whole or not at all (base/out_file.h), and the same bytes each time. */
#ifndef SIM_HOST_FMU_FMU_ARCHIVE_H
#define SIM_HOST_FMU_FMU_ARCHIVE_H

#include "base/error.h"
#include "base/out_file.h"

#include <stddef.h>

typedef struct fmu_archive {
    out_file file;
    void *zip; /* minizip's; NULL: not open */
} fmu_archive;

bool fmu_archive_open(fmu_archive *a, const char *path, error *e);

/* One file, compressed. False with *e set if it could not be written; close then. */
bool fmu_archive_add(fmu_archive *a, const char *name, const void *bytes, size_t length, error *e);

/* Puts it in place if `ok`, else removes it. Returns whether it is in place. */
bool fmu_archive_close(fmu_archive *a, bool ok, error *e);

#endif

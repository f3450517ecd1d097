/* The ZIP archive that an FMU is: written whole or not at all (base/out_file.h), and the same bytes each time. */
#ifndef SIM_HOST_FMU_FMU_ARCHIVE_H
#define SIM_HOST_FMU_FMU_ARCHIVE_H

#include "base/error.h"
#include "base/out_file.h"
#include "base/text_out.h"

#include <stddef.h>
#include <stdint.h>

typedef struct fmu_archive {
    out_file file;
    text_out directory;     /* what the archive's end says of the files so far */
    uint32_t files, offset; /* how many, and where the next one begins */
} fmu_archive;

/* False with *e set, and nothing to close. */
bool fmu_archive_open(fmu_archive *a, const char *path, error *e);

/* One file, compressed. False with *e set if it could not be written; close then. */
bool fmu_archive_add(fmu_archive *a, const char *name, const void *bytes, size_t length, error *e);

/* Puts it in place if `ok`, else removes it. Returns whether it is in place. */
bool fmu_archive_close(fmu_archive *a, bool ok, error *e);

#endif

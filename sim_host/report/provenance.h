/*
 * Where a page comes from: the program's version and commit, the date, the command, and the files it read with their
 * hashes. The date is the only thing of a page that is not the same for the same input; SOURCE_DATE_EPOCH sets it.
 */
#ifndef SIM_HOST_REPORT_PROVENANCE_H
#define SIM_HOST_REPORT_PROVENANCE_H

#include "page.h"

enum { PROVENANCE_FILES = 4 };

typedef struct provenance {
    int argc;
    char **argv; /* as main had it, from the command's name on; none where no command line asked */
    struct {
        const char *what, *path; /* "recording", as the user named it; NULL: it was no file */
    } file[PROVENANCE_FILES];    /* up to the first without a name */
} provenance;

/* Its section of the page. */
void provenance_tell(page *p, const provenance *from);

#endif

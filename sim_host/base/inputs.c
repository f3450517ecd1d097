/* A list of devices and inodes (inputs.h). */
#define _POSIX_C_SOURCE 200809L /* fstat */

#include "inputs.h"

#include <stddef.h>
#include <stdlib.h>
#include <sys/stat.h>

typedef struct identity {
    dev_t device;
    ino_t inode;
} identity;

static bool watched;
static identity *noted;
static size_t count;

void inputs_watch(void)
{
    watched = true;
}

bool inputs_note(int descriptor, const char *path, error *e)
{
    struct stat status;
    if (!watched || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        return true;
    }
    identity *grown = realloc(noted, (count + 1) * sizeof *grown);
    if (grown == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    noted = grown;
    noted[count++] = (identity){status.st_dev, status.st_ino};
    return true;
}

bool inputs_spare(const char *path, error *e)
{
    struct stat status;
    if (count == 0 || stat(path, &status) != 0) {
        return true;
    }
    for (size_t n = 0; n < count; n++) {
        if (noted[n].device == status.st_dev && noted[n].inode == status.st_ino) {
            return error_input(e, path, 0, 0,
                               "is read by this command; expected another name for the output");
        }
    }
    return true;
}

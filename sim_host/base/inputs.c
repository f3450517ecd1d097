/* A list of devices and inodes (inputs.h). */
#define _POSIX_C_SOURCE 200809L /* fstat, strdup */

#include "inputs.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct identity {
    dev_t device;
    ino_t inode;
} identity;

static bool watched;
static identity *noted;
static size_t count;
static char **reserved;
static size_t reserved_count;

void inputs_watch(void)
{
    watched = true;
}

bool inputs_reserve(const char *path, error *e)
{
    if (!watched || strcmp(path, "-") == 0) {
        return true;
    }
    char **grown = realloc(reserved, (reserved_count + 1) * sizeof *grown);
    if (grown != NULL) {
        reserved = grown;
        reserved[reserved_count] = strdup(path);
    }
    if (grown == NULL || reserved[reserved_count] == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    reserved_count++;
    return true;
}

static bool same(identity input, const struct stat *output)
{
    return input.device == output->st_dev && input.inode == output->st_ino;
}

static bool refuse(const char *path, error *e)
{
    return error_input(e, path, 0, 0, "is read by this command; expected another name for the output");
}

static bool not_reserved(identity input, error *e)
{
    struct stat status;
    for (size_t n = 0; n < reserved_count; n++) {
        if (stat(reserved[n], &status) == 0 && same(input, &status)) {
            return refuse(reserved[n], e);
        }
    }
    return true;
}

bool inputs_note(int descriptor, const char *path, error *e)
{
    struct stat status;
    if (!watched || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        return true;
    }
    const identity input = {status.st_dev, status.st_ino};
    if (!not_reserved(input, e)) {
        return false;
    }
    identity *grown = realloc(noted, (count + 1) * sizeof *grown);
    if (grown == NULL) {
        return error_failure(e, 0, "%s: out of memory", path);
    }
    noted = grown;
    noted[count++] = input;
    return true;
}

bool inputs_spare(const char *path, error *e)
{
    struct stat status;
    if (count == 0 || stat(path, &status) != 0) {
        return true;
    }
    for (size_t n = 0; n < count; n++) {
        if (same(noted[n], &status)) {
            return refuse(path, e);
        }
    }
    return true;
}

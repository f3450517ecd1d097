/* Writing beside the old file, and the rename over it (out_file.h). */
#define _GNU_SOURCE /* asprintf; POSIX: mkstemp, fsync, fchmod, realpath */

#include "out_file.h"

#include "leftovers.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The mode of a file that did not exist before: what fopen would have given it; mkstemp gives 0600. */
static mode_t new_file_mode(void)
{
    const mode_t mask = umask(0);
    umask(mask);
    return (mode_t)(0666 & ~mask);
}

static void out_file_release(out_file *f)
{
    if (f->temp_path != NULL) {
        leftovers_forget(f->temp_path);
    }
    free(f->path);
    free(f->temp_path);
    *f = (out_file){0};
}

/* "dir/name" -> "dir/.name.XXXXXX": the same directory, so that rename stays within one file system. */
static char *temp_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    const int directory_length = slash != NULL ? (int)(slash - path) + 1 : 0;
    char *name;
    return asprintf(&name, "%.*s.%s.XXXXXX", directory_length, path, path + directory_length) < 0 ? NULL
                                                                                                  : name;
}

/* A pipe, a terminal or /dev/null cannot be replaced by a rename and is written as it comes. */
static bool open_in_place(out_file *f, const char *path, error *e)
{
    f->stream = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
    if (f->stream == NULL) {
        return error_input(e, path, 0, 0, "cannot be written: %s", strerror(errno));
    }
    return true;
}

static bool open_temporary(out_file *f, mode_t mode, error *e)
{
    f->temp_path = temp_name(f->path);
    if (f->temp_path == NULL) {
        return error_failure(e, 0, "out of memory");
    }
    const int descriptor = mkstemp(f->temp_path);
    if (descriptor < 0) {
        const int why = errno;
        free(f->temp_path);
        f->temp_path = NULL;
        return error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(why));
    }
    leftovers_add(f->temp_path);
    if (fchmod(descriptor, mode) != 0 || (f->stream = fdopen(descriptor, "w")) == NULL) {
        error_failure(e, errno, "%s", f->temp_path);
        close(descriptor);
        unlink(f->temp_path);
        return false;
    }
    return true;
}

bool out_file_open(out_file *f, const char *path, error *e)
{
    *f = (out_file){0};
    if (path[0] == '\0') {
        return error_input(e, NULL, 0, 0, "an output file needs a name, not an empty text");
    }

    struct stat status;
    const bool exists = strcmp(path, "-") != 0 && stat(path, &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) {
        return error_input(e, path, 0, 0, "is a directory; expected the name of a file to write");
    }
    /* Replacing needs only a writable directory; what its owner has locked is still not ours to replace. */
    if (exists && access(path, W_OK) != 0) {
        return error_input(e, path, 0, 0, "cannot be written: %s", strerror(errno));
    }
    const bool in_place = strcmp(path, "-") == 0 || (exists && !S_ISREG(status.st_mode));

    /* Through a symbolic link the file it names is replaced, not the link. */
    f->path = exists && !in_place ? realpath(path, NULL) : strdup(path);
    bool ok;
    if (f->path == NULL) {
        ok = error_failure(e, errno, "%s", path);
    } else if (in_place) {
        ok = open_in_place(f, path, e);
    } else {
        ok = open_temporary(f, exists ? status.st_mode & 07777 : new_file_mode(), e);
    }
    if (!ok) {
        out_file_release(f);
    }
    return ok;
}

/* The errno of what went wrong, or 0. A file in a stage (out_folder.h) goes with the stage on a signal. */
static int put_in_place(const out_file *f)
{
    const bool staged = leftovers_hold_stage_of(f->path);
    if (staged) {
        leftovers_add(f->path);
    }
    if (rename(f->temp_path, f->path) == 0) {
        return 0;
    }
    const int why = errno;
    if (staged) {
        leftovers_forget(f->path);
    }
    return why;
}

bool out_file_commit(out_file *f, error *e)
{
    if (f->stream == NULL) {
        return error_failure(e, 0, "nothing is open for writing");
    }
    int why = 0;
    if (fflush(f->stream) != 0) {
        why = errno;
    } else if (ferror(f->stream)) {
        why = EIO; /* an earlier write failed and its errno is gone */
    }
    if (why == 0 && f->temp_path != NULL && fsync(fileno(f->stream)) != 0) {
        why = errno;
    }
    if (f->stream != stdout && fclose(f->stream) != 0 && why == 0) {
        why = errno;
    }
    f->stream = NULL;
    if (why == 0 && f->temp_path != NULL) {
        why = put_in_place(f);
    }
    if (why != 0) {
        error_failure(e, why, "%s: cannot be written", f->path);
        out_file_abandon(f);
        return false;
    }
    out_file_release(f);
    return true;
}

void out_file_abandon(out_file *f)
{
    if (f->stream != NULL && f->stream != stdout) {
        fclose(f->stream);
    }
    if (f->temp_path != NULL) {
        unlink(f->temp_path);
    }
    out_file_release(f);
}

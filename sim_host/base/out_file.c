/* Writing a hidden file, and its rename over the old file (out_file.h). */
#define _GNU_SOURCE /* F_DUPFD_CLOEXEC; POSIX: fsync, fchmod, realpath */

#include "out_file.h"

#include "inputs.h"
#include "leftovers.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The mode of a file that did not exist before: what fopen would have given it. */
static mode_t new_file_mode(void)
{
    const mode_t mask = umask(0);
    umask(mask);
    return (mode_t)(0666 & ~mask);
}

static void out_file_release(out_file *f)
{
    if (f->temporary.path != NULL) {
        leftovers_forget(f->temporary.path);
    }
    out_unfinished_end(&f->temporary);
    free(f->path);
    *f = (out_file){0};
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

/* The stream has a descriptor of its own: closing it leaves the lock until the file has its name. */
static bool open_temporary(out_file *f, mode_t mode, error *e)
{
    const int why = out_unfinished_make(&f->temporary, f->path, false);
    if (why != 0) {
        return error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(why));
    }
    leftovers_add(f->temporary.path);
    const int descriptor = fcntl(f->temporary.descriptor, F_DUPFD_CLOEXEC, 0);
    f->stream = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    if (f->stream == NULL || fchmod(descriptor, mode) != 0) {
        error_failure(e, errno, "%s: cannot be written", f->path);
        if (f->stream != NULL) {
            fclose(f->stream);
        } else if (descriptor >= 0) {
            close(descriptor);
        }
        unlink(f->temporary.path);
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
    if (!inputs_spare(path, e)) {
        return false;
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
    if (rename(f->temporary.path, f->path) == 0) {
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
    if (why == 0 && f->temporary.path != NULL && fsync(fileno(f->stream)) != 0) {
        why = errno;
    }
    if (f->stream != stdout && fclose(f->stream) != 0 && why == 0) {
        why = errno;
    }
    f->stream = NULL;
    /* An input may have been opened since the output was. */
    if (why == 0 && f->temporary.path != NULL) {
        if (!inputs_spare(f->path, e)) {
            out_file_abandon(f);
            return false;
        }
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
    if (f->temporary.path != NULL) {
        unlink(f->temporary.path);
    }
    out_file_release(f);
}

/* Writing a hidden file, and its rename over the old file (out_file.h). */
#define _GNU_SOURCE /* POSIX: fsync, fchmod, realpath */

#include "out_file.h"

#include "inputs.h"
#include "leftovers.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

_Static_assert(OUT_PATH >= PATH_MAX, "realpath writes so many bytes");

static bool is_stdout(const char *path)
{
    return strcmp(path, "-") == 0;
}

/* The file gets the mode of the one that it replaces (`old`), and until then nobody else may read it. */
static bool open_temporary(out_file *f, const struct stat *old, error *e)
{
    const int why = out_unfinished_make(&f->temporary, f->path, old != NULL ? 0600 : 0666);
    if (why != 0) {
        return error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(why));
    }
    f->stream = fdopen(f->temporary.descriptor, "w");
    if (f->stream == NULL || (old != NULL && fchmod(fileno(f->stream), old->st_mode & 07777) != 0)) {
        return error_failure(e, errno, "%s: cannot be written", f->path);
    }
    f->temporary.descriptor = -1; /* the stream's */
    return true;
}

/* A pipe, a terminal or /dev/null cannot be replaced by a rename and is written as it comes, as is a file in a stage. */
static bool open_in_place(out_file *f, error *e)
{
    if (out_unfinished_holds(f->path)) {
        leftovers_add(f->path);
    }
    f->stream = is_stdout(f->path) ? stdout : fopen(f->path, "w");
    return f->stream != NULL || error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(errno));
}

bool out_file_open(out_file *f, const char *path, error *e)
{
    *f = (out_file){0};
    if (path[0] == '\0') {
        return error_input(e, NULL, 0, 0, "an output file needs a name, not an empty text");
    }
    struct stat status;
    const bool exists = !is_stdout(path) && stat(path, &status) == 0;
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
    const bool in_place =
        is_stdout(path) || (exists && !S_ISREG(status.st_mode)) || out_unfinished_holds(path);
    /* Through a symbolic link the file it names is replaced, not the link. */
    errno = ENAMETOOLONG;
    if (exists && !in_place ? realpath(path, f->path) == NULL
                            : snprintf(f->path, sizeof f->path, "%s", path) >= (int)sizeof f->path) {
        return error_input(e, path, 0, 0, "cannot be written: %s", strerror(errno));
    }
    if (in_place ? open_in_place(f, e) : open_temporary(f, exists ? &status : NULL, e)) {
        return true;
    }
    out_file_abandon(f);
    return false;
}

/* The errno of the first write that failed, or 0. */
static int flush(FILE *stream, bool to_disk)
{
    if (fflush(stream) != 0) {
        return errno;
    }
    if (ferror(stream)) {
        return EIO; /* an earlier write failed and its errno is gone */
    }
    return to_disk && fsync(fileno(stream)) != 0 ? errno : 0;
}

bool out_file_commit(out_file *f, error *e)
{
    if (f->stream == NULL) {
        return error_failure(e, 0, "nothing is open for writing");
    }
    const bool renames = f->temporary.path[0] != '\0';
    int why = flush(f->stream, renames || out_unfinished_holds(f->path));
    /* An input may have been opened since the output was. */
    if (why == 0 && !inputs_spare(f->path, e)) {
        out_file_abandon(f);
        return false;
    }
    if (why == 0 && renames && rename(f->temporary.path, f->path) != 0) {
        why = errno;
    }
    if (why == 0) {
        why = f->stream != stdout && fclose(f->stream) != 0 ? errno : 0;
        f->stream = NULL;
    }
    if (why != 0) {
        error_failure(e, why, "%s: cannot be written", f->path);
        out_file_abandon(f);
        return false;
    }
    out_unfinished_end(&f->temporary, false);
    *f = (out_file){0};
    return true;
}

void out_file_abandon(out_file *f)
{
    out_unfinished_end(&f->temporary, true);
    if (out_unfinished_holds(f->path)) {
        unlink(f->path);
        leftovers_forget(f->path);
    }
    if (f->stream != NULL && f->stream != stdout) {
        fclose(f->stream);
    }
    *f = (out_file){0};
}

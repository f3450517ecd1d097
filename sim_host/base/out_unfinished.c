/* Hidden names, their locks, and what killed processes have left (out_unfinished.h). */
#define _GNU_SOURCE /* flock; POSIX: openat, fdopendir, unlinkat */

#include "out_unfinished.h"

#include "leftovers.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define PREFIX ".iqfoc."

enum { NAME_LONGEST = 64 /* of a hidden name, with a suffix */ };

/* What follows ".iqfoc.123-0" in a text that begins so; else NULL. */
static const char *after_hidden_name(const char *text)
{
    int length = 0;
    (void)sscanf(text, PREFIX "%*[0-9]-%*[0-9]%n", &length);
    return length > 0 ? text + length : NULL;
}

bool out_unfinished_holds(const char *path)
{
    const char *file = strrchr(path, '/');
    const char *folder = file;
    while (folder != NULL && folder > path && folder[-1] != '/') {
        folder--;
    }
    return file != NULL && after_hidden_name(folder) == file;
}

int out_unfinished_left(int directory, const char *name, const char *suffix)
{
    const char *after = after_hidden_name(name);
    if (after == NULL || strcmp(after, suffix) != 0) {
        return -1;
    }
    struct stat status;
    /* (Not to wait for the writer of a pipe.) */
    const int descriptor = openat(directory, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (descriptor >= 0 && fstat(descriptor, &status) == 0 && status.st_uid == geteuid() &&
        (S_ISDIR(status.st_mode) || S_ISREG(status.st_mode)) && flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
        return descriptor;
    }
    if (descriptor >= 0) {
        close(descriptor);
    }
    return -1;
}

void out_unfinished_remove(int directory, const char *name)
{
    const int folder = openat(directory, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *open = folder >= 0 ? fdopendir(folder) : NULL;
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        unlinkat(folder, d->d_name, 0); /* which leaves "." and ".." */
    }
    if (open != NULL) {
        closedir(open);
    } else if (folder >= 0) {
        close(folder);
    }
    unlinkat(directory, name, folder >= 0 ? AT_REMOVEDIR : 0);
}

static void remove_left(const char *directory)
{
    DIR *open = opendir(directory);
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        const int left = out_unfinished_left(dirfd(open), d->d_name, "");
        if (left >= 0) {
            out_unfinished_remove(dirfd(open), d->d_name);
            close(left);
        }
    }
    if (open != NULL) {
        closedir(open);
    }
}

/* Between its making and its lock another process may have taken it for one that was left: then EEXIST, for another name. */
static int make_one(out_unfinished *u, mode_t mode)
{
    const bool folder = S_ISDIR(mode);
    if (folder && mkdir(u->path, mode & 0777) != 0) {
        return errno;
    }
    u->descriptor = folder ? open(u->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC)
                           : open(u->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (u->descriptor < 0) {
        /* A folder that its maker may not read works without a lock: nobody else may either. */
        return !folder ? errno : errno == ENOENT ? EEXIST : 0;
    }
    struct stat status;
    if ((flock(u->descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
        (fstat(u->descriptor, &status) == 0 && status.st_nlink == 0)) {
        close(u->descriptor);
        return EEXIST;
    }
    return 0;
}

int out_unfinished_make(out_unfinished *u, const char *path, mode_t mode)
{
    const char *slash = strrchr(path, '/');
    const size_t length = slash != NULL ? (size_t)(slash - path) + 1 : 0;
    int why = EEXIST;
    if (length + NAME_LONGEST > sizeof u->path) {
        why = ENAMETOOLONG;
    } else {
        memcpy(u->path, path, length);
        u->path[length] = '\0';
        remove_left(length > 0 ? u->path : ".");
    }
    for (int n = 0; why == EEXIST && n < 1000; n++) {
        snprintf(u->path + length, NAME_LONGEST, PREFIX "%ld-%d", (long)getpid(), n);
        why = make_one(u, mode);
    }
    if (why == 0) {
        leftovers_add(u->path);
    } else {
        *u = (out_unfinished){"", -1};
    }
    return why;
}

void out_unfinished_end(out_unfinished *u, bool remove)
{
    if (u->path[0] == '\0') {
        return;
    }
    if (remove) {
        out_unfinished_remove(AT_FDCWD, u->path);
    }
    leftovers_forget(u->path);
    if (u->descriptor >= 0) {
        close(u->descriptor);
    }
    *u = (out_unfinished){"", -1};
}

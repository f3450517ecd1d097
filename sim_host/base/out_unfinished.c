/* Hidden names, their locks, and what killed processes have left (out_unfinished.h). */
#define _GNU_SOURCE /* asprintf, flock; POSIX: openat, fdopendir, unlinkat */

#include "out_unfinished.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define PREFIX ".iqfoc."

/* What follows a number's digits; NULL if there are none. */
static const char *after_digits(const char *text)
{
    const size_t digits = text != NULL ? strspn(text, "0123456789") : 0;
    return digits > 0 ? text + digits : NULL;
}

/* ".iqfoc.123-0" and the suffix. */
static bool is_ours(const char *name, const char *suffix)
{
    const bool begins = strncmp(name, PREFIX, strlen(PREFIX)) == 0;
    const char *after = after_digits(begins ? name + strlen(PREFIX) : NULL);
    after = after_digits(after != NULL && *after == '-' ? after + 1 : NULL);
    return after != NULL && strcmp(after, suffix) == 0;
}

/* The lock of an entry that nobody holds; -1 if somebody does, or it is another user's or no plain file or folder. */
static int take_over(int directory, const char *name)
{
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

static bool is_folder(int descriptor)
{
    struct stat status;
    return fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode);
}

int out_unfinished_left(int directory, const char *name, const char *suffix)
{
    const int descriptor = is_ours(name, suffix) ? take_over(directory, name) : -1;
    if (descriptor >= 0 && !is_folder(descriptor)) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

void out_unfinished_empty(int folder)
{
    DIR *open = fdopendir(folder);
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        unlinkat(folder, d->d_name, 0); /* which leaves "." and ".." */
    }
    if (open != NULL) {
        closedir(open);
    } else {
        close(folder);
    }
}

static void remove_one(int directory, const char *name)
{
    const int descriptor = take_over(directory, name);
    if (descriptor < 0) {
        return;
    }
    if (!is_folder(descriptor)) {
        unlinkat(directory, name, 0);
        close(descriptor);
        return;
    }
    /* The lock is held until the folder is gone. */
    const int inside = dup(descriptor);
    if (inside >= 0) {
        out_unfinished_empty(inside);
    }
    unlinkat(directory, name, AT_REMOVEDIR);
    close(descriptor);
}

/* `length` characters of `path` name the directory, with a slash at the end; 0: the one we are in. */
static void remove_left(const char *path, int length)
{
    char *name;
    if (asprintf(&name, "%.*s", length > 0 ? length : 1, length > 0 ? path : ".") < 0) {
        return;
    }
    DIR *open = opendir(name);
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        if (is_ours(d->d_name, "")) {
            remove_one(dirfd(open), d->d_name);
        }
    }
    if (open != NULL) {
        closedir(open);
    }
    free(name);
}

/* Between its making and its lock another process may have taken it for one that was left: then it wants another name. */
static bool is_lost(int descriptor)
{
    struct stat status;
    return (flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
           (fstat(descriptor, &status) == 0 && status.st_nlink == 0);
}

static int make_one(out_unfinished *u, bool folder)
{
    if (folder && mkdir(u->path, 0777) != 0) {
        return errno;
    }
    u->descriptor = folder ? open(u->path, O_RDONLY | O_DIRECTORY | O_CLOEXEC)
                           : open(u->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (u->descriptor >= 0) {
        if (!is_lost(u->descriptor)) {
            return 0;
        }
        close(u->descriptor);
        u->descriptor = -1;
        return EEXIST;
    }
    /* A folder that its maker may not read works without a lock: nobody else may either. */
    return !folder ? errno : errno == ENOENT ? EEXIST : 0;
}

int out_unfinished_make(out_unfinished *u, const char *path, bool folder)
{
    const char *slash = strrchr(path, '/');
    const int length = slash != NULL ? (int)(slash - path) + 1 : 0;
    *u = (out_unfinished){NULL, -1};
    remove_left(path, length);
    int why = EEXIST;
    for (int n = 0; why == EEXIST && n < 1000; n++) {
        free(u->path);
        if (asprintf(&u->path, "%.*s" PREFIX "%ld-%d", length, path, (long)getpid(), n) < 0) {
            u->path = NULL;
            return ENOMEM;
        }
        why = make_one(u, folder);
    }
    if (why != 0) {
        free(u->path);
        u->path = NULL;
    }
    return why;
}

void out_unfinished_end(out_unfinished *u)
{
    if (u->path != NULL && u->descriptor >= 0) {
        close(u->descriptor);
    }
    free(u->path);
    *u = (out_unfinished){NULL, -1};
}

/*
 * Preloaded into the program by tests/cli/interruptions.py: counts its calls that make, write out, rename or remove files, and at
 * one of them lets happen what cannot be waited for from outside. In the environment:
 *
 *     STOP_AT=N      at the N-th such call, counted from 1
 *     STOP_HOW       kill, int, term: that signal just before it; error: it fails with EIO; full: it and all later ones that need
 *                    room fail with ENOSPC
 *     STOP_COUNT=F   at the end: how many calls there were, into file F
 *     STOP_TRY=F     at the first rename: what comes of an attempt to open a socket, to begin a process and to start a program, into F
 */
#define _GNU_SOURCE /* RTLD_NEXT */

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static long calls;

/* A file of our own, which is not counted. */
static void put_text(const char *path, const char *text)
{
    const long file = syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND, 0666);
    if (file >= 0) {
        (void)syscall(SYS_write, file, text, strlen(text));
        (void)syscall(SYS_close, file);
    }
}

static void put_attempt(const char *path, const char *what, bool done)
{
    const int why = errno;
    char text[80];
    (void)snprintf(text, sizeof text, "%s: %s\n", what, done ? "done" : strerror(why));
    put_text(path, text);
}

/* The program would be another one if the last attempt came off, and its output would be missing. */
static void try_what_is_given_up(void)
{
    static bool tried;
    const char *path = getenv("STOP_TRY");
    if (path == NULL || tried) {
        return;
    }
    tried = true;
    put_attempt(path, "socket", socket(AF_INET, SOCK_STREAM, 0) >= 0);
    const pid_t child = fork();
    if (child == 0) {
        _exit(0);
    }
    put_attempt(path, "process", child > 0);
    char name[] = "/bin/true";
    char *const arguments[] = {name, NULL};
    (void)execv(name, arguments);
    put_attempt(path, "program", false);
}

/* Whether the call is to fail, with errno set. */
static bool stops(bool needs_room, bool may_fail)
{
    const char *at = getenv("STOP_AT");
    const char *how = getenv("STOP_HOW");
    const long stop = at != NULL ? strtol(at, NULL, 10) : 0;
    calls++;
    if (stop == 0 || how == NULL || calls < stop) {
        return false;
    }
    if (strcmp(how, "full") == 0) {
        errno = ENOSPC;
        return needs_room;
    }
    if (calls > stop) {
        return false;
    }
    if (strcmp(how, "error") == 0) {
        errno = EIO;
        return may_fail;
    }
    raise(strcmp(how, "kill") == 0 ? SIGKILL : strcmp(how, "int") == 0 ? SIGINT : SIGTERM);
    return false;
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = getenv("STOP_COUNT");
    if (path != NULL) {
        char text[32];
        (void)snprintf(text, sizeof text, "%ld\n", calls);
        put_text(path, text);
    }
}

/* The next function of the name: the C library's. */
static void next(void *function, const char *name)
{
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(function, &found, sizeof found);
}

static int open_any(const char *name, const char *path, int flags, mode_t mode)
{
    int (*open_next)(const char *, int, ...);
    if ((flags & O_CREAT) != 0 && stops(true, true)) {
        return -1;
    }
    next(&open_next, name);
    return open_next(path, flags, mode);
}

/* NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's names are its own */
int open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(args, mode_t) : 0;
    va_end(args);
    return open_any("open", path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(args, mode_t) : 0;
    va_end(args);
    return open_any("open64", path, flags, mode);
}

int mkdir(const char *path, mode_t mode)
{
    int (*mkdir_next)(const char *, mode_t);
    next(&mkdir_next, "mkdir");
    return stops(true, true) ? -1 : mkdir_next(path, mode);
}

int fchmod(int file, mode_t mode)
{
    int (*fchmod_next)(int, mode_t);
    next(&fchmod_next, "fchmod");
    return stops(false, true) ? -1 : fchmod_next(file, mode);
}

int chmod(const char *path, mode_t mode)
{
    int (*chmod_next)(const char *, mode_t);
    next(&chmod_next, "chmod");
    return stops(false, true) ? -1 : chmod_next(path, mode);
}

/* Words for the terminal are no files. */
int fflush(FILE *stream)
{
    int (*fflush_next)(FILE *);
    next(&fflush_next, "fflush");
    const bool is_file = stream != NULL && stream != stdout && stream != stderr;
    return is_file && stops(true, true) ? EOF : fflush_next(stream);
}

int fsync(int file)
{
    int (*fsync_next)(int);
    next(&fsync_next, "fsync");
    return stops(true, true) ? -1 : fsync_next(file);
}

int rename(const char *from, const char *to)
{
    int (*rename_next)(const char *, const char *);
    next(&rename_next, "rename");
    try_what_is_given_up();
    return stops(false, true) ? -1 : rename_next(from, to);
}

int link(const char *from, const char *to)
{
    int (*link_next)(const char *, const char *);
    next(&link_next, "link");
    return stops(true, true) ? -1 : link_next(from, to);
}

/* What cleans up afterwards is not let fail: there is nothing it could do about that. */
int unlink(const char *path)
{
    int (*unlink_next)(const char *);
    next(&unlink_next, "unlink");
    return stops(false, false) ? -1 : unlink_next(path);
}

int unlinkat(int folder, const char *path, int flags)
{
    int (*unlinkat_next)(int, const char *, int);
    next(&unlinkat_next, "unlinkat");
    return stops(false, false) ? -1 : unlinkat_next(folder, path, flags);
}

int rmdir(const char *path)
{
    int (*rmdir_next)(const char *);
    next(&rmdir_next, "rmdir");
    return stops(false, false) ? -1 : rmdir_next(path);
}
/* NOLINTEND(readability-inconsistent-declaration-parameter-name) */

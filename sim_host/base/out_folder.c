/* The stage of an output folder, and the folders on the way to it (out_folder.h). */
#define _GNU_SOURCE /* asprintf; POSIX: lstat, mkdir, rmdir, strdup, strndup */

#include "out_folder.h"

#include "leftovers.h"
#include "out_folder_files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- Opening ---- */

static bool is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static bool exists(const char *path)
{
    struct stat status;
    return lstat(path, &status) == 0;
}

/* "dir//" -> "dir", "/" stays. */
static char *without_last_slashes(const char *path)
{
    char *copy = strdup(path);
    for (size_t n = copy != NULL ? strlen(copy) : 0; n > 1 && copy[n - 1] == '/'; n--) {
        copy[n - 1] = '\0';
    }
    return copy;
}

/* Makes each folder on the way to f->path that is missing, as mkdir -p; not the last one. */
static bool make_parents(out_folder *f, error *e)
{
    bool ok = true;
    bool made = false;
    for (char *slash = strchr(f->path + 1, '/'); ok && slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(f->path, 0777) == 0) {
            leftovers_add(f->path);
            made = true;
        } else if (is_folder(f->path)) {
            f->there = made ? f->there : strlen(f->path);
        } else {
            ok = errno == EEXIST
                     ? error_input(e, f->path, 0, 0, "is not a directory")
                     : error_input(e, f->path, 0, 0, "the directory cannot be made: %s", strerror(errno));
        }
        *slash = '/';
    }
    return ok;
}

/* In the folder itself if it exists, as its parent may be locked or another file system; else next to it. */
static bool make_stage(out_folder *f, error *e)
{
    char *beside;
    if (asprintf(&beside, "%s%s", f->path, is_folder(f->path) ? "/" : "") < 0) {
        return error_failure(e, 0, "out of memory");
    }
    const int why = out_unfinished_make(&f->own, beside, true);
    free(beside);
    if (why != 0) {
        return error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(why));
    }
    f->stage = f->own.path;
    leftovers_add_stage(f->stage);
    return true;
}

bool out_folder_open(out_folder *f, const char *path, error *e)
{
    *f = (out_folder){0};
    if (path == NULL) {
        return true;
    }
    if (path[0] == '\0') {
        return error_input(e, NULL, 0, 0, "an output directory needs a name, not an empty text");
    }
    if (strlen(path) > OUT_FOLDER_LONGEST) {
        return error_input(e, NULL, 0, 0, "an output directory's path may have %d characters, not %zu",
                           OUT_FOLDER_LONGEST, strlen(path));
    }
    f->path = without_last_slashes(path);
    if (f->path == NULL) {
        return error_failure(e, 0, "out of memory");
    }
    if (!is_folder(f->path) && exists(f->path)) {
        return error_input(e, f->path, 0, 0, "is not a directory");
    }
    return make_parents(f, e) && make_stage(f, e);
}

/* To be a file that a rename can replace: neither stdout nor a pipe, a device or a folder. */
static bool to_be_plain(const char *path)
{
    struct stat status;
    return path != NULL && strcmp(path, "-") != 0 && (stat(path, &status) != 0 || S_ISREG(status.st_mode));
}

bool out_folder_open_for(out_folder *f, const char *const paths[], size_t count, error *e)
{
    *f = (out_folder){0};
    const char *first = NULL;
    size_t named = 0;
    for (size_t n = 0; n < count; n++) {
        named += paths[n] != NULL;
        first = first == NULL && to_be_plain(paths[n]) ? paths[n] : first;
    }
    if (named < 2 || first == NULL) {
        return true;
    }
    const char *slash = strrchr(first, '/');
    char *folder = slash != NULL ? strndup(first, (size_t)(slash - first)) : strdup(".");
    if (folder == NULL) {
        return error_failure(e, 0, "out of memory");
    }
    const bool ok = !is_folder(folder) || out_folder_open(f, folder, e);
    free(folder);
    return ok;
}

/* "./dir" is "dir". */
static const char *without_dots(const char *path)
{
    while (path[0] == '.' && path[1] == '/') {
        path += 1 + strspn(path + 1, "/");
    }
    return path;
}

/* The file's name if the path is one in this very folder, else NULL. */
static const char *name_within(const char *folder, const char *path)
{
    const size_t length = strcmp(folder, ".") != 0 ? strlen(folder) + 1 : 0;
    const bool within = length == 0 || (strncmp(path, folder, length - 1) == 0 && path[length - 1] == '/');
    return within && strchr(path + length, '/') == NULL ? path + length : NULL;
}

const char *out_folder_place(out_folder *f, const char *path, error *e)
{
    const char *file = f->path != NULL ? name_within(without_dots(f->path), without_dots(path)) : NULL;
    struct stat status;
    if (file == NULL || (stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))) {
        return path;
    }
    free(f->placed);
    if (asprintf(&f->placed, "%s/%s", f->stage, file) < 0) {
        f->placed = NULL;
        error_failure(e, 0, "out of memory");
    }
    return f->placed;
}

/* ---- Closing ---- */

/* The parents that were made: no leftovers any more, and removed if they stay empty. */
static void settle_parents(out_folder *f, bool stay)
{
    for (char *slash = strrchr(f->path, '/'); slash != NULL && (size_t)(slash - f->path) > f->there;
         slash = strrchr(f->path, '/')) {
        *slash = '\0';
        leftovers_forget(f->path);
        if (!stay) {
            rmdir(f->path); /* not if another program has written there meanwhile */
        }
    }
}

/* Messages of what wrote into the stage name its files; the user knows them by another folder. */
static void name_users_path(const out_folder *f, error *e)
{
    const char *stage = f->own.path;
    const size_t length = strlen(stage);
    const size_t wanted = strlen(f->path);
    for (char *at = strstr(e->text, stage); at != NULL && length >= wanted; at = strstr(at, stage)) {
        memmove(at + wanted, at + length, strlen(at + length) + 1);
        memcpy(at, f->path, wanted);
        at += wanted;
    }
}

bool out_folder_close(out_folder *f, bool ok, error *e)
{
    if (f->path == NULL) {
        return ok;
    }
    leftovers_signals_wait();
    ok = ok && f->stage != NULL && out_folder_put(&f->own, f->path, e);
    if (f->stage != NULL) {
        out_folder_remove(f->own.path);
        name_users_path(f, e);
    }
    out_unfinished_end(&f->own);
    settle_parents(f, ok);
    leftovers_signals_go_on();
    free(f->path);
    free(f->placed);
    *f = (out_folder){0};
    return ok;
}

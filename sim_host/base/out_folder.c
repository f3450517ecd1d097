/* The stage of an output folder, and the names that belong into it (out_folder.h). */
#define _XOPEN_SOURCE 700 /* POSIX: lstat, mkdir, rmdir */

#include "out_folder.h"

#include "leftovers.h"
#include "out_folder_files.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_folder(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

/* ---- Opening ---- */

/* Finds f->there; false if the next name is taken by something else. */
static bool find_there(out_folder *f, error *e)
{
    struct stat status;
    bool ok = true;
    bool there = true;
    for (size_t n = 1, length = strlen(f->path); there && n <= length; n++) {
        const char after = f->path[n];
        if (after == '/' || after == '\0') {
            f->path[n] = '\0';
            there = is_folder(f->path);
            f->there = there ? n : f->there;
            ok = there || lstat(f->path, &status) != 0 || error_input(e, f->path, 0, 0, "is not a directory");
            f->path[n] = after;
        }
    }
    return ok;
}

/* In the folder itself if it exists, as its parent may be locked or another file system; else where its first missing parent will be. */
static bool make_stage(out_folder *f, error *e)
{
    char next[OUT_FOLDER_LONGEST + 2];
    snprintf(next, sizeof next, "%.*s%s", (int)f->there, f->path,
             f->there > 0 || f->path[0] == '/' ? "/" : "");
    const int why = out_unfinished_make(&f->own, next, S_IFDIR | 0777);
    if (why != 0) {
        return error_input(e, f->path, 0, 0, "cannot be written: %s", strerror(why));
    }
    f->stage = f->own.path;
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
    size_t length = strlen(path);
    if (length > OUT_FOLDER_LONGEST) {
        return error_input(e, NULL, 0, 0, "an output directory's path may have %d characters, not %zu",
                           OUT_FOLDER_LONGEST, length);
    }
    /* "dir//" -> "dir", "/" stays. */
    while (length > 1 && path[length - 1] == '/') {
        length--;
    }
    memcpy(f->path, path, length);
    return find_there(f, e) && make_stage(f, e);
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
    char folder[OUT_PATH];
    const int length = snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(slash - first) : 1,
                                slash != NULL ? first : ".");
    return length >= (int)sizeof folder || !is_folder(folder) || out_folder_open(f, folder, e);
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
    const char *file = f->path[0] != '\0' ? name_within(without_dots(f->path), without_dots(path)) : NULL;
    struct stat status;
    if (file == NULL || (stat(path, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode))) {
        return path;
    }
    if (snprintf(f->placed, sizeof f->placed, "%s/%s", f->stage, file) >= (int)sizeof f->placed) {
        error_input(e, path, 0, 0, "cannot be written: %s", strerror(ENAMETOOLONG));
        return NULL;
    }
    return f->placed;
}

/* ---- Closing ---- */

/* Makes each folder on the way to f->path that is missing, as mkdir -p, or removes those that stayed empty; not the last one. */
static void make_parents(out_folder *f, bool remove)
{
    for (size_t n = f->there + 1, length = strlen(f->path); n < length; n++) {
        const size_t cut = remove ? length + f->there - n : n;
        if (f->path[cut] == '/') {
            f->path[cut] = '\0';
            (void)(remove ? rmdir(f->path) : mkdir(f->path, 0777));
            f->path[cut] = '/';
        }
    }
}

/*
 * A rename takes an empty folder's place too; what has files in it, made by another program since the stage
 * was, is a folder like any that existed before.
 */
static bool put(out_folder *f, error *e)
{
    if (is_folder(f->path)) {
        return out_folder_replace_files(&f->own, f->path, e);
    }
    make_parents(f, false);
    if (rename(f->stage, f->path) == 0) {
        return true;
    }
    if (errno == ENOTEMPTY || errno == EEXIST) {
        return out_folder_replace_files(&f->own, f->path, e);
    }
    error_failure(e, errno, "%s: cannot be written", f->path);
    make_parents(f, true);
    return false;
}

/* Messages of what wrote into the stage name its files; the user knows them by another folder. */
static void name_users_path(const out_folder *f, error *e)
{
    size_t done = 0;
    for (const char *at; done < strlen(e->text) && (at = strstr(e->text + done, f->stage)) != NULL;) {
        const error before = *e;
        done = (size_t)(at - e->text);
        (void)snprintf(e->text + done, sizeof e->text - done, "%s%s", f->path,
                       before.text + done + strlen(f->stage));
        done += strlen(f->path);
    }
}

bool out_folder_close(out_folder *f, bool ok, error *e)
{
    if (f->path[0] == '\0') {
        return ok;
    }
    leftovers_signals_wait();
    ok = ok && f->stage != NULL && put(f, e);
    if (f->stage != NULL) {
        name_users_path(f, e);
    }
    out_unfinished_end(&f->own, true);
    leftovers_signals_go_on();
    *f = (out_folder){0};
    return ok;
}

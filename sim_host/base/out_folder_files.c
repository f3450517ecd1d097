/* Which file of a stage goes where, and all of them or none (out_folder_files.h). */
#define _GNU_SOURCE /* asprintf, flock; POSIX: opendir, realpath, lstat, link */

#include "out_folder_files.h"

#include "inputs.h"
#include "leftovers.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* One file on its way: "stage/name" -> "path/name", the old file -> "stage/.was.name". */
typedef struct mover {
    char *staged, *place, *was;
    bool replaces; /* there is something at its place */
    bool saved;    /* and it is kept in `was` */
    mode_t mode;   /* of what it replaces */
} mover;

typedef struct movers {
    mover *file;
    size_t count;
} movers;

#define WAS ".was."

static char *join(const char *folder, const char *between, const char *name)
{
    char *path;
    return asprintf(&path, "%s%s%s", folder, between, name) < 0 ? NULL : path;
}

static bool is_entry(const char *name)
{
    return strcmp(name, ".") != 0 && strcmp(name, "..") != 0;
}

void out_folder_remove(const char *stage)
{
    const int folder = open(stage, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        out_unfinished_empty(folder);
    }
    rmdir(stage);
    leftovers_forget(stage);
}

/* ---- Which files go where ---- */

static void movers_free(movers *m)
{
    for (size_t n = 0; n < m->count; n++) {
        free(m->file[n].staged);
        free(m->file[n].place);
        free(m->file[n].was);
    }
    free(m->file);
    *m = (movers){0};
}

static bool movers_add(movers *m, const char *stage, const char *path, const char *name)
{
    mover *grown = realloc(m->file, (m->count + 1) * sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    m->file = grown;
    mover *added = &m->file[m->count++];
    *added = (mover){join(stage, "/", name), join(path, "/", name), join(stage, "/" WAS, name), 0, 0, 0};
    return added->staged != NULL && added->place != NULL && added->was != NULL;
}

/* `again`: some have been moved already, and what they replaced is in the stage too. */
static bool movers_find(movers *m, const char *stage, const char *path, bool again, error *e)
{
    DIR *open = opendir(stage);
    if (open == NULL) {
        return error_failure(e, errno, "%s", stage);
    }
    bool ok = true;
    for (struct dirent *d; ok && (d = readdir(open)) != NULL;) {
        const bool old = again && strncmp(d->d_name, WAS, strlen(WAS)) == 0;
        ok = old || !is_entry(d->d_name) || movers_add(m, stage, path, d->d_name);
    }
    closedir(open);
    if (!ok) {
        error_failure(e, 0, "out of memory");
    }
    return ok;
}

/* Everything that can be refused is refused before the first file moves. */
static bool look_at_place(mover *m, error *e)
{
    struct stat status;
    if (lstat(m->place, &status) != 0) {
        return true;
    }
    if (S_ISLNK(status.st_mode) && stat(m->place, &status) == 0) {
        /* Through a symbolic link the file it names is replaced, not the link: as out_file.h does. */
        char *named = realpath(m->place, NULL);
        if (named == NULL) {
            return error_failure(e, errno, "%s", m->place);
        }
        free(m->place);
        m->place = named;
    }
    if (S_ISDIR(status.st_mode)) {
        return error_input(e, m->place, 0, 0, "is a directory; a file of this name is to be written");
    }
    if (!inputs_spare(m->place, e)) {
        return false;
    }
    if (!S_ISLNK(status.st_mode) && access(m->place, W_OK) != 0) {
        return error_input(e, m->place, 0, 0, "cannot be written: %s", strerror(errno));
    }
    m->replaces = true;
    m->mode = S_ISREG(status.st_mode) ? status.st_mode & 07777 : 0;
    return true;
}

/* ---- Moving them ---- */

/* By a second name where the file system has that, so that the file is never missing at its place. */
static bool save_old(mover *m)
{
    m->saved = link(m->place, m->was) == 0 || rename(m->place, m->was) == 0;
    return m->saved;
}

static bool move_one(mover *m)
{
    return (!m->replaces || save_old(m)) && (m->mode == 0 || chmod(m->staged, m->mode) == 0) &&
           rename(m->staged, m->place) == 0;
}

/* Back to what was, from the last file that was moved; the one after it may have been saved without that. */
static void undo(const movers *m, size_t moved)
{
    for (size_t n = moved + 1; n > 0; n--) {
        const mover *file = &m->file[n - 1];
        if (file->saved) {
            rename(file->was, file->place);
        } else if (n <= moved) {
            unlink(file->place);
        }
    }
}

static bool move_all(movers *m, error *e)
{
    for (size_t n = 0; n < m->count; n++) {
        if (!look_at_place(&m->file[n], e)) {
            return false;
        }
    }
    for (size_t n = 0; n < m->count; n++) {
        mover *file = &m->file[n];
        if (!move_one(file)) {
            error_failure(e, errno, "%s: cannot be written", file->place);
            undo(m, n);
            return false;
        }
    }
    return true;
}

/* A process that was killed among its renames: the rest of them. What cannot be moved stays where it is. */
static void finish_one(const char *path, const char *name)
{
    movers m = {0};
    error nobodys = {0};
    char *stage = join(path, "/", name);
    if (stage != NULL && movers_find(&m, stage, path, true, &nobodys) && move_all(&m, &nobodys)) {
        out_folder_remove(stage);
    }
    movers_free(&m);
    free(stage);
}

static void finish_what_was_left(const char *path, int folder)
{
    DIR *open = folder >= 0 ? opendir(path) : NULL;
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        const int left = out_unfinished_left(folder, d->d_name, OUT_UNFINISHED_WHOLE);
        if (left >= 0) {
            finish_one(path, d->d_name);
            close(left);
        }
    }
    if (open != NULL) {
        closedir(open);
    }
}

/* From here on, should this process be killed, the next one finishes its work; until here it would undo it. */
static bool make_whole(out_unfinished *stage, const char *path, error *e)
{
    const char *slash = strrchr(stage->path, '/');
    char *name = join(slash != NULL ? slash + 1 : stage->path, OUT_UNFINISHED_WHOLE, "");
    char *whole = name != NULL ? join(path, "/", name) : NULL;
    free(name);
    if (whole == NULL) {
        return error_failure(e, 0, "out of memory");
    }
    if (rename(stage->path, whole) != 0) {
        error_failure(e, errno, "%s: cannot be written", path);
        free(whole);
        return false;
    }
    leftovers_forget(stage->path);
    free(stage->path);
    stage->path = whole;
    return true;
}

/* One program at a time; where a file system knows no locks it does without. */
static bool replace_files(out_unfinished *stage, const char *path, error *e)
{
    movers m = {0};
    const int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        flock(folder, LOCK_EX);
    }
    finish_what_was_left(path, folder);
    const bool ok =
        make_whole(stage, path, e) && movers_find(&m, stage->path, path, false, e) && move_all(&m, e);
    if (folder >= 0) {
        close(folder);
    }
    movers_free(&m);
    return ok;
}

/*
 * A rename takes an empty folder's place too; what has files in it, made by another program since the stage
 * was, is a folder like any that existed before.
 */
bool out_folder_put(out_unfinished *stage, const char *path, error *e)
{
    struct stat status;
    if (stat(path, &status) == 0) {
        return replace_files(stage, path, e);
    }
    if (rename(stage->path, path) == 0) {
        return true;
    }
    return errno == ENOTEMPTY || errno == EEXIST ? replace_files(stage, path, e)
                                                 : error_failure(e, errno, "%s: cannot be written", path);
}

/* Which file of a stage goes where, and all of them or none (out_folder_files.h). */
#define _GNU_SOURCE /* flock; POSIX: scandir, realpath, lstat, link */

#include "out_folder_files.h"

#include "inputs.h"
#include "leftovers.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define WAS   ".was."  /* before the name of a file that is replaced, while it is kept in the stage */
#define WHOLE ".whole" /* ends the name of a stage whose files are on their way */

_Static_assert(OUT_PATH >= PATH_MAX, "realpath writes so many bytes");

/* The three names of a file on its way. */
typedef struct move {
    char staged[OUT_PATH]; /* "stage/name" */
    char was[OUT_PATH];    /* "stage/.was.name" */
    char place
        [OUT_PATH]; /* "path/name"; through a symbolic link the file it names is replaced, not the link */
} move;

static bool join(char joined[OUT_PATH], const char *folder, const char *between, const char *name, error *e)
{
    const bool fits = snprintf(joined, OUT_PATH, "%s/%s%s", folder, between, name) < OUT_PATH;
    return fits || error_input(e, folder, 0, 0, "cannot be written: %s", strerror(ENAMETOOLONG));
}

static bool take_names(move *m, const char *stage, const char *path, const char *name, error *e)
{
    char named[OUT_PATH];
    struct stat status;
    if (!join(m->staged, stage, "", name, e) || !join(m->was, stage, WAS, name, e) ||
        !join(m->place, path, "", name, e)) {
        return false;
    }
    if (lstat(m->place, &status) == 0 && S_ISLNK(status.st_mode) && realpath(m->place, named) != NULL) {
        strcpy(m->place, named);
    }
    return true;
}

/* Everything that can be refused is refused before the first file moves. */
static bool may_take_place(const move *m, error *e)
{
    struct stat status;
    if (stat(m->place, &status) != 0) {
        return true;
    }
    if (S_ISDIR(status.st_mode)) {
        return error_input(e, m->place, 0, 0, "is a directory; a file of this name is to be written");
    }
    if (!inputs_spare(m->place, e)) {
        return false;
    }
    return access(m->place, W_OK) == 0 ||
           error_input(e, m->place, 0, 0, "cannot be written: %s", strerror(errno));
}

/* The old file is kept by a second name where the file system has that, so that it is never missing at its place. */
static bool move_one(const move *m)
{
    struct stat old;
    if (lstat(m->place, &old) == 0 &&
        ((link(m->place, m->was) != 0 && rename(m->place, m->was) != 0) ||
         (S_ISREG(old.st_mode) && chmod(m->staged, old.st_mode & 07777) != 0))) {
        return false;
    }
    return rename(m->staged, m->place) == 0;
}

/* Back to the old file, or to none. */
static void undo_one(const move *m)
{
    if (rename(m->was, m->place) != 0 && access(m->staged, F_OK) != 0) {
        unlink(m->place);
    }
}

static int is_to_move(const struct dirent *entry)
{
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
           strncmp(entry->d_name, WAS, strlen(WAS)) != 0;
}

static bool move_all(const char *stage, const char *path, error *e)
{
    struct dirent **file;
    const int count = scandir(stage, &file, is_to_move, NULL);
    if (count < 0) {
        return error_failure(e, errno, "%s", stage);
    }
    move m;
    bool ok = true;
    for (int n = 0; ok && n < count; n++) {
        ok = take_names(&m, stage, path, file[n]->d_name, e) && may_take_place(&m, e);
    }
    int moved = 0;
    while (ok && moved < count) {
        ok = take_names(&m, stage, path, file[moved]->d_name, e) && move_one(&m);
        moved += ok;
    }
    if (!ok && e->status == 0) {
        error_failure(e, errno, "%s: cannot be written", m.place);
        for (int n = moved; n >= 0; n--) {
            (void)take_names(&m, stage, path, file[n]->d_name, e);
            undo_one(&m);
        }
    }
    for (int n = 0; n < count; n++) {
        free(file[n]);
    }
    free(file);
    return ok;
}

/* A process that was killed among its renames: the rest of them. What cannot be moved stays where it is. */
static void finish_what_was_left(const char *path)
{
    DIR *open = opendir(path);
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        char stage[OUT_PATH];
        error nobodys = {0};
        const int left = out_unfinished_left(dirfd(open), d->d_name, WHOLE);
        if (left >= 0) {
            if (join(stage, path, "", d->d_name, &nobodys) && move_all(stage, path, &nobodys)) {
                out_unfinished_remove(dirfd(open), d->d_name);
            }
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
    char whole[OUT_PATH];
    const char *slash = strrchr(stage->path, '/');
    if (!join(whole, path, slash != NULL ? slash + 1 : stage->path, WHOLE, e)) {
        return false;
    }
    if (rename(stage->path, whole) != 0) {
        return error_failure(e, errno, "%s: cannot be written", path);
    }
    leftovers_forget(stage->path);
    strcpy(stage->path, whole);
    return true;
}

/* One program at a time; where a file system knows no locks it does without. */
bool out_folder_replace_files(out_unfinished *stage, const char *path, error *e)
{
    const int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        flock(folder, LOCK_EX);
    }
    finish_what_was_left(path);
    const bool ok = make_whole(stage, path, e) && move_all(stage->path, path, e);
    if (folder >= 0) {
        close(folder);
    }
    return ok;
}

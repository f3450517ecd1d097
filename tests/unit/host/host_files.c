/* POSIX: mkdtemp, opendir. */
#define _XOPEN_SOURCE 700

#include "host_files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char directory[] = "/tmp/iqfoc_test_XXXXXX";

const char *scratch_begin(void)
{
    if (mkdtemp(directory) == NULL) {
        perror(directory);
        exit(1);
    }
    return directory;
}

/* Calls act on each name but . and .. ; returns how many there are. */
static size_t for_each(void (*act)(const char *path))
{
    DIR *open = opendir(directory);
    size_t count = 0;
    for (struct dirent *d; open != NULL && (d = readdir(open)) != NULL;) {
        if (strcmp(d->d_name, ".") != 0 && strcmp(d->d_name, "..") != 0) {
            count++;
            if (act != NULL) {
                act(scratch_path(d->d_name));
            }
        }
    }
    if (open != NULL) {
        closedir(open);
    }
    return count;
}

static void remove_path(const char *path)
{
    if (remove(path) != 0) {
        perror(path);
    }
}

void scratch_end(void)
{
    for_each(remove_path);
    rmdir(directory);
}

size_t scratch_count(void)
{
    return for_each(NULL);
}

const char *scratch_path(const char *name)
{
    static char paths[4][400];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

const char *scratch_file(const char *name, const void *bytes, size_t length)
{
    const char *path = scratch_path(name);
    FILE *out = fopen(path, "wb");
    if (out == NULL || fwrite(bytes, 1, length, out) != length || fclose(out) != 0) {
        perror(path);
        exit(1);
    }
    return path;
}

const char *scratch_text(const char *name, const char *text)
{
    return scratch_file(name, text, strlen(text));
}

char *scratch_read(const char *name)
{
    FILE *in = fopen(scratch_path(name), "rb");
    if (in == NULL) {
        return NULL;
    }
    fseek(in, 0, SEEK_END);
    const size_t size = (size_t)ftell(in);
    rewind(in);
    char *text = calloc(1, size + 1);
    if (text == NULL || fread(text, 1, size, in) != size) {
        perror(name);
        exit(1);
    }
    fclose(in);
    return text;
}

/* POSIX: open, dup. */
#define _XOPEN_SOURCE 700

#include "line_source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum {
    BLOCK_SIZE = 256 * 1024,
    /* No recording has lines this long; a binary file may have no line end at all and is not to fill the
       memory. */
    LONGEST_LINE = 1024 * 1024
};

bool line_source_open(line_source *s, const char *path, error *e)
{
    const bool is_stdin = strcmp(path, "-") == 0;
    *s = (line_source){.path = is_stdin ? "stdin" : path};
    const int descriptor = is_stdin ? dup(STDIN_FILENO) : open(path, O_RDONLY);
    if (descriptor < 0) {
        return error_input(e, path, 0, 0, "cannot be read: %s", strerror(errno));
    }
    struct stat status;
    if (fstat(descriptor, &status) == 0 && S_ISDIR(status.st_mode)) {
        close(descriptor);
        return error_input(e, path, 0, 0, "is a directory; expected a file");
    }
    s->block = malloc(BLOCK_SIZE);
    s->stream = gzdopen(descriptor, "rb");
    if (s->stream == NULL) {
        close(descriptor);
    }
    if (s->block == NULL || s->stream == NULL) {
        line_source_close(s);
        return error_failure(e, 0, "%s: out of memory", path);
    }
    gzbuffer(s->stream, BLOCK_SIZE);
    return true;
}

/* The next block; false at the end of the file or with *e set.
 * A gzip file that was cut is an error, not an end. */
static bool block_read(line_source *s, error *e)
{
    const int got = gzread(s->stream, s->block, BLOCK_SIZE);
    int code = Z_OK;
    const char *why = gzerror(s->stream, &code);
    if (got >= 0 && (code == Z_OK || code == Z_STREAM_END)) {
        s->at = 0;
        s->end = (size_t)got;
        return got > 0;
    }
    const long line = s->length > 0 ? s->number : s->number + 1;
    const long column = (long)s->length + 1;
    if (code == Z_ERRNO) {
        return error_input(e, s->path, line, column, "cannot be read: %s", strerror(errno));
    }
    const char *colon = strstr(why, ": "); /* zlib puts its own name of the file in front */
    return error_input(e, s->path, line, column, "the gzip data is cut or damaged from here on (%s)",
                       colon != NULL ? colon + 2 : why);
}

/* Appends to ->joined, which then is the current line. */
static bool join(line_source *s, const char *text, size_t length, error *e)
{
    const size_t need = s->length + length;
    if (need > LONGEST_LINE) {
        return error_input(e, s->path, s->number, 0, "the line is longer than 1 MiB; expected a CSV file");
    }
    if (need > s->joined_size) {
        const size_t size = need < 4096 ? 4096 : 2 * need;
        char *grown = realloc(s->joined, size);
        if (grown == NULL) {
            return error_failure(e, 0, "%s: out of memory", s->path);
        }
        s->joined = grown;
        s->joined_size = size;
    }
    memcpy(s->joined + s->length, text, length);
    s->line = s->joined;
    s->length = need;
    return true;
}

bool line_source_next(line_source *s, error *e)
{
    s->line = NULL;
    s->length = 0;
    bool complete = false;
    while (!complete) {
        if (s->at == s->end && !block_read(s, e)) {
            break;
        }
        if (s->length == 0) {
            s->number++;
        }
        const char *text = s->block + s->at;
        const size_t there = s->end - s->at;
        const char *newline = memchr(text, '\n', there);
        const size_t length = newline != NULL ? (size_t)(newline - text) + 1 : there;
        complete = newline != NULL;
        s->at += length;
        if (complete && s->length == 0) {
            /* The common case: the whole line lies in the block, no copy. */
            s->line = text;
            s->length = length;
        } else if (!join(s, text, length, e)) {
            return false;
        }
    }
    return e->status == STATUS_DONE && s->length > 0;
}

void line_source_close(line_source *s)
{
    if (s->stream != NULL) {
        gzclose(s->stream);
    }
    free(s->block);
    free(s->joined);
    *s = (line_source){0};
}

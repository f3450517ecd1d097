/* Lines by zlib, which reads what is not packed as it is (line_source.h). */
#define _XOPEN_SOURCE 700 /* POSIX: open, dup */

#include "line_source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { BLOCK_SIZE = 256 * 1024, BUFFER_SIZE = LINE_SOURCE_LONGEST + 1 + BLOCK_SIZE };

/* More than hours of a fast drive: a small file that unpacks without an end is not to keep anyone waiting. */
static const size_t MOST_BYTES = (size_t)4 << 30;

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
    s->buffer = malloc(BUFFER_SIZE);
    s->stream = gzdopen(descriptor, "rb");
    if (s->stream == NULL) {
        close(descriptor);
    }
    if (s->buffer == NULL || s->stream == NULL) {
        line_source_close(s);
        return error_failure(e, 0, "%s: out of memory", path);
    }
    gzbuffer(s->stream, BLOCK_SIZE);
    return true;
}

/*
 * A gzip file that was cut or damaged is an error, not an end. zlib knows of it once it has unpacked that far, and
 * what it has unpacked with the damage is not used any more. It is complained of where the text breaks off.
 */
static bool check_stream(const line_source *s, error *e)
{
    int code = Z_OK;
    const char *why = gzerror(s->stream, &code);
    if (code == Z_OK || code == Z_STREAM_END) {
        return true;
    }
    long line = s->number + 1;
    size_t begin = s->at;
    for (size_t k = s->at; k < s->end; k++) {
        if (s->buffer[k] == '\n') {
            line++;
            begin = k + 1;
        }
    }
    const long column = (long)(s->end - begin) + 1;
    if (code == Z_ERRNO) {
        return error_input(e, s->path, line, column, "cannot be read: %s", strerror(errno));
    }
    const char *colon = strstr(why, ": "); /* zlib puts its own name of the file in front */
    return error_input(e, s->path, line, column, "the gzip data is cut or damaged from here on (%s)",
                       colon != NULL ? colon + 2 : why);
}

/* Reads a block behind what is left of the one before; false at the end, and with *e set on damage. */
static bool fill(line_source *s, error *e)
{
    const size_t left = s->end - s->at;
    memmove(s->buffer, s->buffer + s->at, left);
    s->at = 0;
    s->end = left;
    const int got = gzread(s->stream, s->buffer + left, BLOCK_SIZE);
    s->end += got > 0 ? (size_t)got : 0;
    s->bytes += got > 0 ? (size_t)got : 0;
    s->is_end = got <= 0;
    if (!check_stream(s, e)) {
        return false;
    }
    if (s->bytes > MOST_BYTES) {
        return error_input(e, s->path, s->number + 1, 0,
                           "the file is larger than 4 GiB; expected a recording");
    }
    return got > 0;
}

bool line_source_next(line_source *s, error *e)
{
    const char *newline = NULL;
    size_t searched = 0;
    for (;;) {
        newline = memchr(s->buffer + s->at + searched, '\n', s->end - s->at - searched);
        searched = s->end - s->at;
        if (newline != NULL || searched > LINE_SOURCE_LONGEST || s->is_end || !fill(s, e)) {
            break;
        }
    }
    s->line = s->buffer + s->at;
    s->length = newline != NULL ? (size_t)(newline + 1 - s->line) : s->end - s->at;
    s->at += s->length;
    s->number += s->length > 0 ? 1 : 0;
    if (s->length > LINE_SOURCE_LONGEST) {
        return error_input(e, s->path, s->number, 0, "the line is longer than 1 MiB; expected a CSV file");
    }
    return e->status == STATUS_DONE && s->length > 0;
}

bool line_source_block(line_source *s, char **bytes, size_t *length, error *e)
{
    const int got = gzread(s->stream, s->buffer, BLOCK_SIZE);
    *bytes = s->buffer;
    *length = got > 0 ? (size_t)got : 0;
    return check_stream(s, e) && got > 0;
}

void line_source_close(line_source *s)
{
    if (s->stream != NULL) {
        gzclose(s->stream);
    }
    free(s->buffer);
    *s = (line_source){0};
}

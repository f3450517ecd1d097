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

enum {
    BLOCK_SIZE = 256 * 1024,
    /* No recording has lines this long; a binary file, which may have no line end, is not to fill memory. */
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
    s->buffer = malloc(LONGEST_LINE + 2);
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
 * A gzip file that was cut or damaged is an error, not an end. zlib knows of it once it has unpacked that
 * far, and lines that it has unpacked with the damage are not used any more.
 */
static bool check_stream(const line_source *s, bool whole, error *e)
{
    int code = Z_OK;
    const char *why = gzerror(s->stream, &code);
    if (code == Z_OK || code == Z_STREAM_END) {
        return true;
    }
    const long line = s->length > 0 ? s->number : s->number + 1;
    const long column = whole ? 1 : (long)s->length + 1;
    if (code == Z_ERRNO) {
        return error_input(e, s->path, line, column, "cannot be read: %s", strerror(errno));
    }
    const char *colon = strstr(why, ": "); /* zlib puts its own name of the file in front */
    return error_input(e, s->path, line, column, "the gzip data is cut or damaged from here on (%s)",
                       colon != NULL ? colon + 2 : why);
}

bool line_source_next(line_source *s, error *e)
{
    const z_off_t start = gztell(s->stream);
    const bool got = gzgets(s->stream, s->buffer, LONGEST_LINE + 2) != NULL;
    s->line = s->buffer;
    s->length = (size_t)(gztell(s->stream) - start); /* a binary file has zeros in its lines */
    s->number += s->length > 0 ? 1 : 0;
    if (s->length > LONGEST_LINE) {
        return error_input(e, s->path, s->number, 0, "the line is longer than 1 MiB; expected a CSV file");
    }
    const bool whole = got && s->line[s->length - 1] == '\n';
    return check_stream(s, whole, e) && got;
}

bool line_source_block(line_source *s, char **bytes, size_t *length, error *e)
{
    const int got = gzread(s->stream, s->buffer, BLOCK_SIZE);
    *bytes = s->buffer;
    *length = got > 0 ? (size_t)got : 0;
    return check_stream(s, false, e) && got > 0;
}

void line_source_close(line_source *s)
{
    if (s->stream != NULL) {
        gzclose(s->stream);
    }
    free(s->buffer);
    *s = (line_source){0};
}

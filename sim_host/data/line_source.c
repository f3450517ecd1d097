/* Lines of what a byte source gives (line_source.h). */
#define _XOPEN_SOURCE 700 /* POSIX: open, dup */

#include "line_source.h"

#include "../base/inputs.h"
#include "byte_source.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { BUFFER_SIZE = LINE_SOURCE_LONGEST + 1 + BYTE_SOURCE_BLOCK };

/* More than hours of a fast drive: a small file that unpacks without an end is not to keep anyone waiting. */
static const uint64_t MOST_BYTES = UINT64_C(4) << 30;

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
    if (!inputs_note(descriptor, s->path, e)) {
        close(descriptor);
        return false;
    }
    s->buffer = malloc(BUFFER_SIZE);
    s->bytes_of = byte_source_open(descriptor);
    if (s->buffer == NULL || s->bytes_of == NULL) {
        line_source_close(s);
        return error_failure(e, 0, "%s: out of memory", path);
    }
    return true;
}

/* Damage is complained of where the text breaks off. */
static bool check_stream(const line_source *s, error *e)
{
    char words[BYTE_SOURCE_COMPLAINT];
    if (!byte_source_complaint(s->bytes_of, words)) {
        return true;
    }
    long line = s->number + 1;
    size_t begin = s->offset;
    for (size_t k = s->offset; k < s->end; k++) {
        if (s->buffer[k] == '\n') {
            line++;
            begin = k + 1;
        }
    }
    return error_input(e, s->path, line, (long)(s->end - begin) + 1, "%s", words);
}

/* Reads a block behind what is left of the one before; false at the end, and with *e set on damage. */
static bool fill(line_source *s, error *e)
{
    const size_t left = s->end - s->offset;
    memmove(s->buffer, s->buffer + s->offset, left);
    s->offset = 0;
    s->end = left;
    const size_t got = byte_source_read(s->bytes_of, s->buffer + left, BYTE_SOURCE_BLOCK);
    s->end += got;
    s->bytes += got;
    s->is_end = got == 0;
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
        newline = memchr(s->buffer + s->offset + searched, '\n', s->end - s->offset - searched);
        searched = s->end - s->offset;
        if (newline != NULL || searched > LINE_SOURCE_LONGEST || s->is_end || !fill(s, e)) {
            break;
        }
    }
    s->line = s->buffer + s->offset;
    s->length = newline != NULL ? (size_t)(newline + 1 - s->line) : s->end - s->offset;
    s->offset += s->length;
    s->number += s->length > 0 ? 1 : 0;
    if (s->length > LINE_SOURCE_LONGEST) {
        return error_input(e, s->path, s->number, 0, "the line is longer than 1 MiB; expected a CSV file");
    }
    return e->status == STATUS_DONE && s->length > 0;
}

bool line_source_block(line_source *s, char **bytes, size_t *length, error *e)
{
    *length = byte_source_read(s->bytes_of, s->buffer, BYTE_SOURCE_BLOCK);
    *bytes = s->buffer;
    return check_stream(s, e) && *length > 0;
}

void line_source_close(line_source *s)
{
    byte_source_close(s->bytes_of);
    free(s->buffer);
    *s = (line_source){0};
}

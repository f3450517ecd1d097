/* Plain and packed files by zlib, which reads what is not packed as it is (byte_source.h). */
#include "byte_source.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

/*
 * Measured rows pack to a third of their size, rows at standstill to a thirtieth. A file that unpacks to more is a decompression bomb,
 * and is refused after the first megabytes.
 */
enum { RATIO_MOST = 100, UNPACKED_FREE = 16 * 1024 * 1024 };

struct byte_source {
    gzFile file;
    bool swells;
};

byte_source *byte_source_open(int descriptor)
{
    byte_source *s = calloc(1, sizeof *s);
    if (s == NULL || (s->file = gzdopen(descriptor, "rb")) == NULL) {
        close(descriptor);
        free(s);
        return NULL;
    }
    gzbuffer(s->file, BYTE_SOURCE_BLOCK);
    return s;
}

size_t byte_source_read(byte_source *s, char *to, size_t most)
{
    const int got = gzread(s->file, to, (unsigned)most);
    const z_off_t unpacked = gztell(s->file);
    const z_off_t packed = gzoffset(s->file); /* -1: of a pipe nobody knows */
    s->swells = packed > 0 && unpacked > UNPACKED_FREE && unpacked / RATIO_MOST > packed;
    return got > 0 && !s->swells ? (size_t)got : 0;
}

/*
 * A gzip file that was cut or damaged is an error, not an end. zlib knows of it once it has unpacked that far, and what it has
 * unpacked with the damage is not used any more.
 */
bool byte_source_complaint(byte_source *s, char words[BYTE_SOURCE_COMPLAINT])
{
    if (s->swells) {
        (void)snprintf(words, BYTE_SOURCE_COMPLAINT,
                       "unpacks to more than %d times its size; expected a recording", RATIO_MOST);
        return true;
    }
    int code = Z_OK;
    const char *why = gzerror(s->file, &code);
    if (code == Z_OK || code == Z_STREAM_END) {
        return false;
    }
    const char *colon = strstr(why, ": "); /* zlib puts its own name of the file in front */
    if (code == Z_ERRNO) {
        (void)snprintf(words, BYTE_SOURCE_COMPLAINT, "cannot be read: %s", strerror(errno));
    } else {
        (void)snprintf(words, BYTE_SOURCE_COMPLAINT, "the gzip data is cut or damaged from here on (%s)",
                       colon != NULL ? colon + 2 : why);
    }
    return true;
}

void byte_source_close(byte_source *s)
{
    if (s != NULL) {
        gzclose(s->file);
        free(s);
    }
}

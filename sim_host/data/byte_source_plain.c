/* Plain files only: a packed one is refused by its first bytes (byte_source.h). */
#define _XOPEN_SOURCE 700 /* POSIX: read */

#include "byte_source.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct byte_source {
    int descriptor;
    int failed; /* errno */
    bool started;
    bool packed;
};

byte_source *byte_source_open(int descriptor)
{
    byte_source *s = calloc(1, sizeof *s);
    if (s == NULL) {
        close(descriptor);
        return NULL;
    }
    s->descriptor = descriptor;
    return s;
}

/* A pipe may give less than was asked for. */
size_t byte_source_read(byte_source *s, char *to, size_t most)
{
    size_t got = 0;
    while (got < most && s->failed == 0 && !s->packed) {
        const ssize_t more = read(s->descriptor, to + got, most - got);
        if (more < 0 && errno != EINTR) {
            s->failed = errno;
        } else if (more == 0) {
            break;
        } else if (more > 0) {
            got += (size_t)more;
        }
    }
    s->packed = s->packed || (!s->started && got >= 2 && memcmp(to, "\x1F\x8B", 2) == 0);
    s->started = true;
    return s->packed ? 0 : got;
}

bool byte_source_complaint(byte_source *s, char words[BYTE_SOURCE_COMPLAINT])
{
    if (s->packed) {
        (void)snprintf(words, BYTE_SOURCE_COMPLAINT,
                       "is packed (gzip), and this program was built without zlib; unpack it first");
    } else if (s->failed != 0) {
        (void)snprintf(words, BYTE_SOURCE_COMPLAINT, "cannot be read: %s", strerror(s->failed));
    }
    return s->packed || s->failed != 0;
}

void byte_source_close(byte_source *s)
{
    if (s != NULL) {
        close(s->descriptor);
        free(s);
    }
}

/* A stream of the C library over a block that grows (text_out.h). */
#define _GNU_SOURCE /* fopencookie */

#include "text_out.h"

#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

static ssize_t take(void *context, const char *bytes, size_t length)
{
    text_out *t = context;
    if (!t->failed && t->length + length >= t->room) {
        const size_t room = 2 * (t->length + length) + 256;
        char *grown = realloc(t->bytes, room);
        if (grown == NULL) {
            t->failed = true;
        } else {
            t->bytes = grown;
            t->room = room;
        }
    }
    if (t->failed) {
        return 0;
    }
    memcpy(t->bytes + t->length, bytes, length);
    t->length += length;
    t->bytes[t->length] = '\0';
    return (ssize_t)length;
}

bool text_out_open(text_out *t)
{
    *t = (text_out){0};
    t->bytes = calloc(1, 1);
    t->room = 1;
    t->stream = t->bytes != NULL ? fopencookie(t, "w", (cookie_io_functions_t){.write = take}) : NULL;
    return t->stream != NULL;
}

bool text_out_close(text_out *t)
{
    const bool ok = t->stream != NULL && fclose(t->stream) == 0 && !t->failed;
    t->stream = NULL;
    if (!ok) {
        free(t->bytes);
        t->bytes = NULL;
    }
    return ok;
}

void text_out_comment(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        const unsigned char c = (unsigned char)*text;
        fputc(c < 0x20 || c == '*' || c == 0x5c ? '_' : c, out);
    }
}

/* Three bytes are four letters (base64.h). */
#include "base64.h"

static void put(base64 *b)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned long bits =
        (unsigned long)b->kept[0] << 16 | (unsigned long)b->kept[1] << 8 | (unsigned long)b->kept[2];
    char text[4];
    for (size_t n = 0; n < 4; n++) {
        text[n] = n <= b->count ? letters[bits >> (18 - 6 * n) & 63] : '=';
    }
    fwrite(text, 1, sizeof text, b->out);
    *b = (base64){.out = b->out};
}

void base64_add(base64 *b, const void *bytes, size_t count)
{
    const unsigned char *from = bytes;
    for (size_t n = 0; n < count; n++) {
        b->kept[b->count++] = from[n];
        if (b->count == 3) {
            put(b);
        }
    }
}

void base64_end(base64 *b)
{
    if (b->count > 0) {
        put(b);
    }
}

/* A small file, whole (text_file.h). */
#include "text_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *text_file_read(const char *path, size_t largest, const char *expected, size_t *length, error *e)
{
    FILE *stream = fopen(path, "rb");
    if (stream == NULL) {
        error_input(e, path, 0, 0, "cannot be read: %s", strerror(errno));
        return NULL;
    }
    /* One byte more than allowed is asked for: getting it shows that there is too much. */
    char *text = malloc(largest + 2);
    if (text == NULL) {
        fclose(stream);
        error_failure(e, 0, "%s: out of memory", path);
        return NULL;
    }
    *length = fread(text, 1, largest + 1, stream);
    const int why = ferror(stream) ? errno : 0;
    fclose(stream);
    if (why != 0) {
        error_input(e, path, 0, 0, "cannot be read: %s", strerror(why));
    } else if (*length > largest) {
        error_input(e, path, 0, 0, "is larger than %zu bytes; expected %s", largest, expected);
    } else {
        text[*length] = '\0';
        return text;
    }
    free(text);
    return NULL;
}

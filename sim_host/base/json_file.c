/* JSON as a file of its own (json_file.h). */
#include "json_file.h"

#include "out_file.h"

#include <string.h>

bool json_file_write(const char *path, const json_t *value, error *e)
{
    if (value == NULL) {
        return error_failure(e, 0, "%s: a value that is not a number would have to be written", path);
    }
    out_file f;
    if (!out_file_open(&f, path, e)) {
        return false;
    }
    json_print(f.stream, value);
    fputc('\n', f.stream);
    return out_file_commit(&f, e);
}

bool json_file_place(out_folder *f, const char *path, json_t *value, error *e)
{
    const char *place = path != NULL ? out_folder_place(f, path, e) : NULL;
    const bool ok = path == NULL || (place != NULL && json_file_write(place, value, e));
    json_free(value);
    return ok;
}

bool json_file_is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

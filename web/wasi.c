/*
 * What a browser has not: a second descriptor for standard input; threads, so that the pieces of work run one after the other; other
 * programs; and other readers of a file while it is written, so that it needs no hidden name.
 */
#include "wasi.h"

#include "base/memory.h"
#include "base/out_file.h"
#include "base/parallel.h"
#include "report/plot.h"

#include <errno.h>
#include <stdlib.h>

int dup(int descriptor)
{
    (void)descriptor;
    errno = ENOSYS;
    return -1;
}

size_t parallel_workers(void)
{
    return 1;
}

void parallel_for(size_t count, void (*job)(void *context, size_t index, size_t worker), void *context)
{
    for (size_t k = 0; k < count; k++) {
        job(context, k, 0);
    }
}

void memory_out(void)
{
    fputs("iqfoc: out of memory\n", stderr);
    _Exit(STATUS_FAILED);
}

bool out_file_open(out_file *f, const char *path, error *e)
{
    *f = (out_file){.stream = fopen(path, "w")};
    (void)snprintf(f->path, sizeof f->path, "%s", path);
    return f->stream != NULL || error_failure(e, errno, "%s: cannot be written", path);
}

bool out_file_commit(out_file *f, error *e)
{
    const bool ok = fclose(f->stream) == 0;
    f->stream = NULL;
    return ok || error_failure(e, errno, "%s: cannot be written", f->path);
}

void out_file_abandon(out_file *f)
{
    if (f->stream != NULL) {
        fclose(f->stream);
        f->stream = NULL;
    }
}

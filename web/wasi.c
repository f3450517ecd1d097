/* What a browser has not: a second descriptor for standard input, and threads; the pieces of work run one after the other. */
#include "wasi.h"

#include "base/parallel.h"

#include <errno.h>

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

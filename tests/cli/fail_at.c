/*
 * Preloaded into the program by tests/cli/out_of_memory.py: counts its allocations and lets one of them fail. In the environment:
 *
 *     FAIL_AT=N      the N-th allocation fails with ENOMEM, counted from 1
 *     FAIL_COUNT=F   at the end: how many allocations there were, into file F
 *
 * What the loader and this library's own start need is not counted.
 */
#define _GNU_SOURCE /* POSIX: open, write */

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The C library's own, under the names that it keeps for this. */
extern void *__libc_malloc(size_t size);                     /* NOLINT(bugprone-reserved-identifier) */
extern void *__libc_calloc(size_t count, size_t size);       /* NOLINT(bugprone-reserved-identifier) */
extern void *__libc_realloc(void *block, size_t size);       /* NOLINT(bugprone-reserved-identifier) */
extern void *__libc_memalign(size_t alignment, size_t size); /* NOLINT(bugprone-reserved-identifier) */

static atomic_long allocations;
static long fail_at;
static bool counts;

__attribute__((constructor)) static void begin(void)
{
    const char *at = getenv("FAIL_AT");
    fail_at = at != NULL ? strtol(at, NULL, 10) : 0;
    counts = true;
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = getenv("FAIL_COUNT");
    counts = false;
    if (path != NULL) {
        char text[32];
        const int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&allocations));
        const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (file >= 0) {
            (void)!write(file, text, (size_t)length);
            (void)close(file);
        }
    }
}

static bool fails(void)
{
    if (!counts || atomic_fetch_add(&allocations, 1) + 1 != fail_at) {
        return false;
    }
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t size)
{
    return fails() ? NULL : __libc_realloc(block, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return fails() ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    if (fails()) {
        return ENOMEM;
    }
    *block = __libc_memalign(alignment, size);
    return *block == NULL ? ENOMEM : 0;
}

/* Common parts of the fuzzers (fuzz.h). */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct memory_file {
    int file; /* less than 1: none yet */
    char path[64];
} memory_file;

static void open_empty(memory_file *m, const char *name)
{
    if (m->file < 1) {
        m->file = memfd_create(name, 0);
        fuzz_expect(m->file > 0, "the fuzzer itself: a file in memory");
        snprintf(m->path, sizeof m->path, "/proc/self/fd/%d", m->file);
    }
    fuzz_expect(ftruncate(m->file, 0) == 0 && lseek(m->file, 0, SEEK_SET) == 0,
                "the fuzzer itself: an empty file");
}

const char *fuzz_file(const uint8_t *data, size_t size)
{
    static memory_file input;
    open_empty(&input, "input");
    while (size > 0) {
        const ssize_t written = write(input.file, data, size);
        fuzz_expect(written > 0, "the fuzzer itself: a write into memory");
        data += written;
        size -= (size_t)written;
    }
    return input.path;
}

const char *fuzz_output(void)
{
    static char path[64];
    if (path[0] == '\0') {
        snprintf(path, sizeof path, "/dev/shm/iqfoc-fuzz-%ld", (long)getpid());
    }
    unlink(path);
    return path;
}

void fuzz_expect(bool kept, const char *promise)
{
    if (!kept) {
        fprintf(stderr, "broken promise: %s\n", promise);
        abort();
    }
}

void fuzz_expect_refusal(const error *e)
{
    fuzz_expect(e->status == STATUS_UNUSABLE, "what cannot be used ends with status 2");
    fuzz_expect(e->text[0] != '\0' && strchr(e->text, '\n') == NULL, "a refusal is one line");
}

/* Is the word there, not as a part of another? */
static bool has_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    const char *at = text;
    while ((at = strcasestr(at, word)) != NULL) {
        const char before = at == text ? ' ' : at[-1];
        const char after = at[length];
        if (strchr(" \t\n-+(,:[", before) != NULL && (after == '\0' || strchr(" \t\n%,)]", after) != NULL)) {
            return true;
        }
        at += length;
    }
    return false;
}

void fuzz_expect_numbers(const char *text)
{
    fuzz_expect(!has_word(text, "nan") && !has_word(text, "inf"), "neither nan nor inf is reported");
}

uint32_t fuzz_take(fuzz_bytes *b, size_t bytes)
{
    uint32_t value = 0;
    for (size_t k = 0; k < bytes && b->left > 0; k++) {
        value |= (uint32_t)*b->data << (8 * k);
        b->data++;
        b->left--;
    }
    return value;
}

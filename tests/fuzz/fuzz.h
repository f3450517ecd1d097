/*
 * Common parts of the fuzzers: their input as a file, and the program's promises for any input.
 *
 * libFuzzer looks for the sanitizers' findings. A broken promise ends the process too (fuzz_expect), with a line that
 * names it.
 */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The path of a file in memory that holds just these bytes; the same path every time. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* The path of a second such file, empty, for what the program writes. */
const char *fuzz_output(void);

void fuzz_expect(bool kept, const char *promise);

/* A refusal is one clear line and says that the input cannot be used. */
void fuzz_expect_refusal(const error *e);

/* Neither nan nor inf is ever reported. */
void fuzz_expect_numbers(const char *text);

/* The next bytes of an input that is read as a list of choices; zeros after its end. */
typedef struct fuzz_bytes {
    const uint8_t *data;
    size_t left;
} fuzz_bytes;

uint32_t fuzz_take(fuzz_bytes *b, size_t bytes);

#endif

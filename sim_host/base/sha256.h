/*
 * SHA-256 (FIPS 180-4), for saying which file a page or a result was made of. Not for secrets.
 *
 *     sha256 s = sha256_begin();
 *     sha256_add(&s, bytes, count); ...
 *     sha256_end(&s, digest);
 */
#ifndef SIM_HOST_BASE_SHA256_H
#define SIM_HOST_BASE_SHA256_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SHA256_BYTES = 32, SHA256_TEXT = 2 * SHA256_BYTES + 1 };

typedef struct sha256 {
    uint32_t state[8];
    uint64_t length; /* bytes taken so far */
    unsigned char block[64];
} sha256;

sha256 sha256_begin(void);
void sha256_add(sha256 *s, const void *bytes, size_t count);
void sha256_end(sha256 *s, unsigned char digest[SHA256_BYTES]);

/* The digest of a file in hexadecimal digits. False, and `text` empty, where it cannot be read a second time: stdin. */
bool sha256_of_file(const char *path, char text[SHA256_TEXT]);

#endif

/* Base64 (RFC 4648) as a stream: takes bytes, writes text. */
#ifndef SIM_HOST_BASE_BASE64_H
#define SIM_HOST_BASE_BASE64_H

#include <stddef.h>
#include <stdio.h>

typedef struct base64 {
    FILE *out;
    unsigned char kept[3];
    size_t count; /* bytes kept, less than three */
} base64;

/* Starts with `(base64){.out = stream}`. */
void base64_add(base64 *b, const void *bytes, size_t count);
/* Writes what is kept, padded. */
void base64_end(base64 *b);

#endif

/* SHA-256, block by block (sha256.h). */
#include "sha256.h"

#include <stdio.h>
#include <string.h>

/* FIPS 180-4, 4.2.2: the first 32 bits of the fractions of the cube roots of the first 64 primes. */
static const uint32_t round_constant[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

static uint32_t turned(uint32_t x, int by)
{
    return x >> by | x << (32 - by);
}

static void take_block(sha256 *s)
{
    uint32_t w[64];
    uint32_t v[8];
    for (int n = 0; n < 16; n++) {
        const unsigned char *at = &s->block[4 * n];
        w[n] = (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
    }
    for (int n = 16; n < 64; n++) {
        const uint32_t low = turned(w[n - 15], 7) ^ turned(w[n - 15], 18) ^ w[n - 15] >> 3;
        const uint32_t high = turned(w[n - 2], 17) ^ turned(w[n - 2], 19) ^ w[n - 2] >> 10;
        w[n] = w[n - 16] + low + w[n - 7] + high;
    }
    memcpy(v, s->state, sizeof v);
    for (int n = 0; n < 64; n++) {
        const uint32_t choice = (v[4] & v[5]) ^ (~v[4] & v[6]);
        const uint32_t majority = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]);
        const uint32_t first = v[7] + (turned(v[4], 6) ^ turned(v[4], 11) ^ turned(v[4], 25)) + choice +
                               round_constant[n] + w[n];
        const uint32_t second = (turned(v[0], 2) ^ turned(v[0], 13) ^ turned(v[0], 22)) + majority;
        memmove(&v[1], &v[0], 7 * sizeof v[0]);
        v[4] += first;
        v[0] = first + second;
    }
    for (int n = 0; n < 8; n++) {
        s->state[n] += v[n];
    }
}

sha256 sha256_begin(void)
{
    return (sha256){.state = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c,
                              0x1f83d9ab, 0x5be0cd19}};
}

void sha256_add(sha256 *s, const void *bytes, size_t count)
{
    const unsigned char *from = bytes;
    while (count > 0) {
        const size_t used = s->length % sizeof s->block;
        const size_t room = sizeof s->block - used;
        const size_t taken = count < room ? count : room;
        memcpy(&s->block[used], from, taken);
        s->length += taken;
        from += taken;
        count -= taken;
        if (taken == room) {
            take_block(s);
        }
    }
}

void sha256_end(sha256 *s, unsigned char digest[SHA256_BYTES])
{
    static const unsigned char padding[64] = {0x80};
    const uint64_t bits = 8 * s->length;
    const size_t used = s->length % sizeof s->block;
    unsigned char length[8];
    for (int n = 0; n < 8; n++) {
        length[n] = (unsigned char)(bits >> (56 - 8 * n));
    }
    sha256_add(s, padding, used < 56 ? 56 - used : 120 - used);
    sha256_add(s, length, sizeof length);
    for (int n = 0; n < SHA256_BYTES; n++) {
        digest[n] = (unsigned char)(s->state[n / 4] >> (24 - 8 * (n % 4)));
    }
}

bool sha256_of_file(const char *path, char text[SHA256_TEXT])
{
    sha256 s = sha256_begin();
    unsigned char digest[SHA256_BYTES];
    unsigned char part[65536];
    size_t got;
    text[0] = '\0';
    FILE *file = strcmp(path, "-") != 0 ? fopen(path, "rb") : NULL;
    if (file == NULL) {
        return false;
    }
    while ((got = fread(part, 1, sizeof part, file)) > 0) {
        sha256_add(&s, part, got);
    }
    const bool whole = ferror(file) == 0;
    fclose(file);
    if (!whole) {
        return false;
    }
    sha256_end(&s, digest);
    for (int n = 0; n < SHA256_BYTES; n++) {
        snprintf(&text[2 * n], 3, "%02x", digest[n]);
    }
    return true;
}

/*
 * ZIP over an output file that is already open (fmu_archive.h): PKWARE's APPNOTE.TXT 6.3, sections 4.3.7 (a file's head), 4.3.12 (its
 * entry in the directory) and 4.3.16 (the end). zlib compresses; every allocation is checked.
 */
#define ZLIB_CONST /* its input is not written to */

#include "fmu_archive.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum {
    FILE_HEAD = 0x04034b50,
    DIRECTORY_ENTRY = 0x02014b50,
    END = 0x06054b50,
    FILE_HEAD_SIZE = 30,
    VERSION = 20,           /* 2.0, the first that knows folders and deflate */
    FIRST_DAY = 1 << 5 | 1, /* 1980-01-01, so that the same input makes the same archive */
    LARGEST = INT_MAX / 4,  /* of a file: all sizes and places in the archive are below 2^32 */
    MEMORY_LEVEL = 8        /* zlib's own default, which deflateInit2 has no name for */
};

typedef struct entry {
    const char *name;
    uint32_t checksum, packed, length;
} entry;

/* As many octets of a number, the lowest first. */
static void put(FILE *out, uint32_t number, int octets)
{
    for (int k = 0; k < octets; k++) {
        fputc((int)(number >> (8 * k) & 0xff), out);
    }
}

/* What a file's head and its entry in the directory share: from the version needed to the length of the extra field. */
static void put_about(FILE *out, const entry *f)
{
    put(out, VERSION, 2);
    put(out, 0, 2); /* flags */
    put(out, Z_DEFLATED, 2);
    put(out, 0, 2); /* time */
    put(out, FIRST_DAY, 2);
    put(out, f->checksum, 4);
    put(out, f->packed, 4);
    put(out, f->length, 4);
    put(out, (uint32_t)strlen(f->name), 2);
    put(out, 0, 2); /* no extra field */
}

static void put_file(FILE *out, const entry *f, const void *packed)
{
    put(out, FILE_HEAD, 4);
    put_about(out, f);
    fputs(f->name, out);
    fwrite(packed, 1, f->packed, out);
}

static void put_entry(FILE *out, const entry *f, uint32_t offset)
{
    put(out, DIRECTORY_ENTRY, 4);
    put(out, 0, 2); /* made by: MS-DOS, without attributes */
    put_about(out, f);
    put(out, 0, 2); /* no comment */
    put(out, 0, 2); /* disk */
    put(out, 0, 2); /* attributes */
    put(out, 0, 4);
    put(out, offset, 4);
    fputs(f->name, out);
}

/* Packs into a block to be freed; NULL when out of memory. */
static void *pack(const void *bytes, size_t length, uint32_t *packed)
{
    z_stream z = {.next_in = bytes, .avail_in = (uInt)length};
    if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
        return NULL;
    }
    const uLong room = deflateBound(&z, (uLong)length);
    void *out = malloc(room);
    z.next_out = out;
    z.avail_out = (uInt)room;
    if (out != NULL && deflate(&z, Z_FINISH) != Z_STREAM_END) {
        free(out);
        out = NULL;
    }
    *packed = (uint32_t)z.total_out;
    (void)deflateEnd(&z);
    return out;
}

bool fmu_archive_open(fmu_archive *a, const char *path, error *e)
{
    memset(a, 0, sizeof *a);
    if (!out_file_open(&a->file, path, e)) {
        return false;
    }
    if (!text_out_open(&a->directory)) {
        (void)text_out_close(&a->directory);
        out_file_abandon(&a->file);
        return error_failure(e, 0, "%s: out of memory for the archive", path);
    }
    return true;
}

bool fmu_archive_add(fmu_archive *a, const char *name, const void *bytes, size_t length, error *e)
{
    if (length > LARGEST) {
        return error_failure(e, 0, "%s: too large for the archive", name);
    }
    entry f = {.name = name, .length = (uint32_t)length};
    f.checksum = (uint32_t)crc32(0, bytes, (uInt)length);
    void *packed = pack(bytes, length, &f.packed);
    if (packed == NULL) {
        return error_failure(e, 0, "%s: out of memory to pack it", name);
    }
    put_file(a->file.stream, &f, packed);
    put_entry(a->directory.stream, &f, a->offset);
    a->offset += FILE_HEAD_SIZE + (uint32_t)strlen(name) + f.packed;
    a->files++;
    free(packed);
    return true;
}

/* The directory and the end. */
static void put_end(const fmu_archive *a)
{
    FILE *out = a->file.stream;
    fwrite(a->directory.bytes, 1, a->directory.length, out);
    put(out, END, 4);
    put(out, 0, 2); /* this disk, and that of the directory */
    put(out, 0, 2);
    put(out, a->files, 2); /* on this disk, and in all */
    put(out, a->files, 2);
    put(out, (uint32_t)a->directory.length, 4);
    put(out, a->offset, 4);
    put(out, 0, 2); /* no comment */
}

bool fmu_archive_close(fmu_archive *a, bool ok, error *e)
{
    const bool listed = text_out_close(&a->directory);
    if (ok && listed) {
        put_end(a);
    }
    free(a->directory.bytes);
    if (ok && !listed) {
        error_failure(e, 0, "out of memory for the archive");
    }
    if (!ok || !listed) {
        out_file_abandon(&a->file);
        return false;
    }
    return out_file_commit(&a->file, e);
}

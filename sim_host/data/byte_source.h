/*
 * The bytes of a file, unpacked if it is gzip (recognised by its first bytes). byte_source_gzip.c uses zlib; byte_source_plain.c reads
 * plain files only, for a build without zlib. The option IQFOC_ZLIB chooses.
 */
#ifndef SIM_HOST_DATA_BYTE_SOURCE_H
#define SIM_HOST_DATA_BYTE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>

enum { BYTE_SOURCE_BLOCK = 256 * 1024, BYTE_SOURCE_COMPLAINT = 160 };

typedef struct byte_source byte_source;

/* Takes the descriptor, also where it fails. NULL: out of memory. */
byte_source *byte_source_open(int descriptor);

/* At most BYTE_SOURCE_BLOCK bytes; 0 at the end or on damage. */
size_t byte_source_read(byte_source *s, char *to, size_t most);

/* The reason why reading stopped; false if there was no error. */
bool byte_source_complaint(byte_source *s, char words[BYTE_SOURCE_COMPLAINT]);

/* NULL is allowed. */
void byte_source_close(byte_source *s);

#endif

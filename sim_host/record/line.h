/* Source of the recorder's bytes: a serial device, a pseudo-terminal, a socket, a pipe or a file. */
#ifndef SIM_HOST_RECORD_LINE_H
#define SIM_HOST_RECORD_LINE_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef struct line {
    const char *name; /* as the user gave it */
    int file;
    long size; /* of a plain file, in octets; else 0 */
} line;

/*
 * Opens what `name` is: a terminal is set to raw octets at `baud`, a socket of the file system is connected
 * to. False with *e set if it cannot be read or the speed is none that the system has.
 */
bool line_open(line *l, const char *name, long baud, error *e);

/* Waits at most wait_ms for octets. *count = 0: none came in time. *closed: there will be no more. */
bool line_read(line *l, uint8_t *octets, size_t size, int wait_ms, size_t *count, bool *closed, error *e);

void line_close(line *l);

#endif

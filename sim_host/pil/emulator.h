/*
 * Runs an emulator as a child process and talks to it over its serial line.
 *
 * Whatever happens to either side, the child does not outlive this process (the kernel kills it with its parent), and no wait is longer
 * than the time limit.
 */
#ifndef SIM_HOST_PIL_EMULATOR_H
#define SIM_HOST_PIL_EMULATOR_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* Longest silence of the emulator before it counts as hung. The start included: QEMU takes 0.1 s for it. */
#define EMULATOR_SILENCE_MAX_S 4.0

typedef struct emulator {
    const char *name; /* "cortex-m4", for messages; must outlive the struct */
    pid_t pid;        /* 0: not running */
    int line;         /* the socket that is its serial line */
} emulator;

/* argv: NULL-terminated; argv[0], the program, is looked up in PATH. False with *e set if it does not start. */
bool emulator_start(emulator *m, const char *name, const char *const argv[], error *e);

/* Sends all bytes. False with *e set if the child is gone or does not take them in time. */
bool emulator_send(emulator *m, const uint8_t *bytes, size_t count, error *e);

/* Receives *received bytes, 1 to count. False with *e set if the child is gone or silent for too long. */
bool emulator_receive(emulator *m, uint8_t *bytes, size_t count, size_t *received, error *e);

/* Hangs up and lets the child end by itself. False with *e set if it does not, in time and with status 0. */
bool emulator_finish(emulator *m, error *e);

/* Kills the child. Safe to call twice and on a zeroed struct. */
void emulator_stop(emulator *m);

#endif

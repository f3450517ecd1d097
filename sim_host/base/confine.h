/*
 * Drops rights that the process does not need, for good, before it reads the first input file. If a malicious file takes over the
 * process, it can start no program and reach no network.
 *
 * On Linux (x86-64, arm64) the kernel then answers EPERM to whatever starts a program or a process, opens a socket, looks into or
 * signals another process, loads code into the kernel, mounts, or changes a name space or a user (what may start programs may be
 * another user, as gnuplot asks to be its caller); and no program gets more rights than we have. Files stay as open to it as to its
 * user. Elsewhere, and where the kernel knows no filters (qemu-user), nothing happens, and the program works all the same. Built
 * with the address sanitizer it may start programs, which that needs.
 */
#ifndef SIM_HOST_BASE_CONFINE_H
#define SIM_HOST_BASE_CONFINE_H

/* What is still needed. */
enum {
    CONFINE_TO_FILES = 0,    /* nothing of the kind */
    CONFINE_MAY_START = 1,   /* programs: gnuplot, an emulator */
    CONFINE_MAY_CONNECT = 2, /* sockets */
};

/* May be called again with less; what has been given up stays so. All threads that are begun later inherit it. */
void confine(unsigned needed);

#endif

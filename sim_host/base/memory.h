/*
 * The end of the program when the memory of its C++ parts runs out: one line of bad news, status 1, nothing left behind. C parts get a
 * NULL and report it by error.h; C++ parts (JSON, TOML, Eigen) would throw through C functions.
 */
#ifndef SIM_HOST_BASE_MEMORY_H
#define SIM_HOST_BASE_MEMORY_H

#ifdef __cplusplus
extern "C" {
#endif

/* From now on. For a program's main only: a library must not end the process of its caller. */
void memory_end_when_out(void);

/* Ends the process so: for whoever has no caller to report it to. */
void memory_out(void) __attribute__((noreturn));

#ifdef __cplusplus
}
#endif

#endif

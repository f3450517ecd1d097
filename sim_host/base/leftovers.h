/*
 * Temporary files and folders that are removed if a signal ends the process, such as Ctrl-C during a long simulation. The first
 * added path installs handlers for SIGINT, SIGTERM, SIGHUP and SIGPIPE; a signal that is already handled or ignored keeps its
 * handler. The process still dies of the signal, so its caller sees the cause.
 */
#ifndef SIM_HOST_BASE_LEFTOVERS_H
#define SIM_HOST_BASE_LEFTOVERS_H

#ifdef __cplusplus
extern "C" {
#endif

/*
 * From now on a signal removes this path, which need not exist: a file, or a folder that is empty by then.
 * What was added last is removed first, so that files go before the folder they are in. The text is copied.
 * Without memory for that the path is merely not removed.
 */
void leftovers_add(const char *path);

/* The path and what is in it stay, or are gone already. Nothing happens if none of them was added. */
void leftovers_forget(const char *path);

/* Removes all that was added, for a process that ends without unwinding; may be called from a signal's handler. */
void leftovers_remove(void);

/* No signal comes through between the two; one that arrives meanwhile is delivered by the second. */
void leftovers_signals_wait(void);
void leftovers_signals_go_on(void);

#ifdef __cplusplus
}
#endif

#endif

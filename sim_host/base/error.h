/*
 * One error message in one line, as docs/interfaces.md defines it: file, line, column, and the expected value. A function that can fail
 * takes an `error *` and returns false; its caller returns the error unchanged. Only the command prints it (error_print) and chooses the
 * exit status.
 */
#ifndef SIM_HOST_BASE_ERROR_H
#define SIM_HOST_BASE_ERROR_H

#include <stdarg.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the process exits with: interfaces.md, "The command line". */
enum {
    STATUS_DONE = 0,    /* whatever the verdict */
    STATUS_FAILED = 1,  /* the program itself failed: no memory, no disk */
    STATUS_UNUSABLE = 2 /* input or usage that cannot be used */
};

typedef struct error {
    int status;     /* STATUS_UNUSABLE or STATUS_FAILED; 0: no error yet */
    char text[512]; /* one line, no newline at its end */
} error;

#if defined(__GNUC__)
#define ERROR_PRINTF(format_at, args_at) __attribute__((format(printf, format_at, args_at)))
#else
#define ERROR_PRINTF(format_at, args_at)
#endif

/*
 * Sets "FILE:LINE:COLUMN: text" with status 2; a line or column of 0 is left out, a NULL file too.
 * The first error set stays. Returns false, so that a caller can `return error_input(...)`.
 */
bool error_input(error *e, const char *file, long line, long column, const char *format, ...)
    ERROR_PRINTF(5, 6);

/* The same for a function that has taken such arguments itself. */
bool error_input_args(error *e, const char *file, long line, long column, const char *format, va_list args);

/* The same for a failure of the program itself: status 1. Appends strerror(errno_value) if it is not 0. */
bool error_failure(error *e, int errno_value, const char *format, ...) ERROR_PRINTF(3, 4);

/* Prints "iqfoc: <text>" and a newline on stderr; returns e->status for exit(). */
int error_print(const error *e);

#ifdef __cplusplus
}
#endif

#endif

/*
 * A progress line on stderr: "simulate: 42 % of 500000 cycles", rewritten in place a few times a second.
 *
 * Nothing is printed unless stderr is a terminal, so that logs and pipes stay clean, nor before half a second
 * has passed, so that short work stays silent.
 */
#ifndef SIM_HOST_BASE_PROGRESS_H
#define SIM_HOST_BASE_PROGRESS_H

#include "error.h"

typedef struct progress {
    const char *what; /* "simulate" */
    const char *unit; /* "cycles" */
    double total;     /* > 0; 0: unknown */
    bool shown;       /* the terminal holds our line */
    bool wanted;      /* stderr is a terminal */
    double next_s;    /* monotonic time of the next rewrite */
} progress;

/* The texts must outlive the struct. */
progress progress_begin(const char *what, double total, const char *unit);

/* Cheap enough to call every few hundred cycles: a clock read, and rarely a line. */
void progress_update(progress *p, double done);

/* The same with a line of the caller's own, for work of unknown length (a total of 0). */
void progress_say(progress *p, const char *format, ...) ERROR_PRINTF(2, 3);

/* Seconds on a clock that nobody sets. */
double progress_clock_s(void);

/* Clears the line, so that what follows starts on a clean one. */
void progress_end(progress *p);

#endif

/* The progress line, and when it is due (progress.h). */
#define _XOPEN_SOURCE 700 /* POSIX: clock_gettime, isatty */

#include "progress.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double first_line_after_s = 0.5;
static const double rewrite_every_s = 0.2;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

progress progress_begin(const char *what, double total, const char *unit)
{
    return (progress){.what = what,
                      .unit = unit,
                      .total = total,
                      .wanted = total > 0.0 && isatty(STDERR_FILENO) == 1,
                      .next_s = now_s() + first_line_after_s};
}

void progress_update(progress *p, double done)
{
    if (!p->wanted) {
        return;
    }
    const double now = now_s();
    if (now < p->next_s) {
        return;
    }
    fprintf(stderr, "\r%s: %3.0f %% of %.0f %s\033[K", p->what, 100.0 * done / p->total, p->total, p->unit);
    fflush(stderr);
    p->shown = true;
    p->next_s = now + rewrite_every_s;
}

void progress_end(progress *p)
{
    if (p->shown) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        p->shown = false;
    }
}

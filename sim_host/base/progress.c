/* The progress line, and when it is due (progress.h). */
#define _XOPEN_SOURCE 700 /* POSIX: clock_gettime, isatty */

#include "progress.h"

#include <stdarg.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static const double first_line_after_s = 0.5;
static const double rewrite_every_s = 0.2;

double progress_clock_s(void)
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
                      .wanted = isatty(STDERR_FILENO) == 1,
                      .next_s = progress_clock_s() + first_line_after_s};
}

void progress_say(progress *p, const char *format, ...)
{
    const double now_s = p->wanted ? progress_clock_s() : 0.0;
    if (!p->wanted || now_s < p->next_s) {
        return;
    }
    va_list args;
    va_start(args, format);
    fputc('\r', stderr);
    vfprintf(stderr, format, args);
    fputs("\033[K", stderr);
    fflush(stderr);
    va_end(args);
    p->shown = true;
    p->next_s = now_s + rewrite_every_s;
}

void progress_update(progress *p, double done)
{
    if (p->total > 0.0) {
        progress_say(p, "%s: %3.0f %% of %.0f %s", p->what, 100.0 * done / p->total, p->total, p->unit);
    }
}

void progress_end(progress *p)
{
    if (p->shown) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        p->shown = false;
    }
}

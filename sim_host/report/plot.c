/* POSIX: open_memstream, posix_spawn. */
#define _POSIX_C_SOURCE 200809L

#include "plot.h"

#include "../base/text_out.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static void say_style(plot *p, int style, const char *colour, double width, const char *dash)
{
    plot_say(p, "set style line %d linewidth %g linecolor rgb '%s' pointtype 7 pointsize 0.55 %s\n", style,
             width, colour, dash);
}

bool plot_begin(plot *p, int width, int height, error *e)
{
    *p = (plot){0};
    p->script = open_memstream(&p->text, &p->size);
    if (p->script == NULL) {
        return error_failure(e, errno, "plot");
    }
    plot_say(p,
             "set terminal svg size %d,%d dynamic enhanced font 'sans-serif,13' linewidth 1 butt\n"
             "set encoding utf8\nset border 3 linecolor rgb '" PLOT_INK "' linewidth 0.8\n"
             "set tics nomirror out scale 0.6 textcolor rgb '" PLOT_INK "'\n"
             "set grid linetype 1 linecolor rgb '" PLOT_GRID "' linewidth 0.8 dashtype solid\n"
             "set xtics offset 0,0.4\n"
             "set key textcolor rgb '" PLOT_INK "' Left reverse samplen 2.2 spacing 1.15\n"
             "set xlabel offset 0,0.8 textcolor rgb '" PLOT_INK "'\n"
             "set ylabel offset 0.6,0 textcolor rgb '" PLOT_INK "'\n"
             "set title offset 0,-0.4 textcolor rgb '" PLOT_INK "'\nset minussign\nset samples 400\n",
             width, height);
    say_style(p, 1, PLOT_BLUE, 1.8, "");
    say_style(p, 2, PLOT_ORANGE, 1.8, "");
    say_style(p, 3, PLOT_GREEN, 1.8, "");
    say_style(p, 4, PLOT_PURPLE, 1.8, "");
    say_style(p, 9, PLOT_FAINT, 1.2, "");
    return true;
}

void plot_say(plot *p, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vfprintf(p->script, format, args);
    va_end(args);
}

void plot_data(plot *p, const char *name)
{
    plot_say(p, "$%s << END_OF_DATA\n", name);
}

void plot_data_end(plot *p)
{
    plot_say(p, "END_OF_DATA\n");
}

void plot_abandon(plot *p)
{
    if (p->script != NULL) {
        fclose(p->script);
    }
    free(p->text);
    *p = (plot){0};
}

/* All that a stream holds, as text. NULL when memory runs out. */
static char *read_all(FILE *stream)
{
    text_out all;
    if (!text_out_open(&all)) {
        (void)text_out_close(&all);
        return NULL;
    }
    char block[65536];
    size_t got;
    while ((got = fread(block, 1, sizeof block, stream)) > 0) {
        fwrite(block, 1, got, all.stream);
    }
    if (!text_out_close(&all)) {
        return NULL;
    }
    return all.bytes;
}

/* The script as a file without a name, which is gone with the last who has it open, whatever ends him. */
static FILE *script_file(const plot *p, error *e)
{
    FILE *script = tmpfile();
    if (script == NULL || fwrite(p->text, 1, p->size, script) != p->size || fflush(script) != 0 ||
        lseek(fileno(script), 0, SEEK_SET) != 0) { /* the child reads from where we stand */
        error_failure(e, errno, "plot: its script cannot be written");
        if (script != NULL) {
            fclose(script);
        }
        return NULL;
    }
    return script;
}

/*
 * Runs a program as it is named, with no shell between that could take a word for more than a word. `in` is its stdin, `out` gets
 * its stdout; -1 where it has nothing to read or nobody listens. False if it cannot be run.
 */
static bool start(const char *const argv[], int in, int out, pid_t *pid)
{
    posix_spawn_file_actions_t files;
    if (posix_spawn_file_actions_init(&files) != 0) {
        return false;
    }
    bool ok = in >= 0 ? posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO) == 0
                      : posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0) == 0;
    if (out >= 0) {
        ok = ok && posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO) == 0;
    } else {
        ok = ok && posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0) == 0 &&
             posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO) == 0;
    }
    fflush(NULL);
    ok = ok && posix_spawnp(pid, argv[0], &files, NULL, (char *const *)argv, environ) ==
                   0; /* argv stays as it is */
    posix_spawn_file_actions_destroy(&files);
    return ok;
}

/* Whether it ended well. */
static bool ended_well(pid_t pid)
{
    int status = 0;
    pid_t ended = waitpid(pid, &status, 0);
    while (ended < 0 && errno == EINTR) {
        ended = waitpid(pid, &status, 0);
    }
    return ended == pid && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static char *run_gnuplot(FILE *script, error *e)
{
    /* By its "-" an error in the script ends it; without a word it would go on. */
    const char *const argv[] = {"gnuplot", "-", NULL};
    int ends[2];
    if (pipe(ends) != 0) {
        error_failure(e, errno, "gnuplot");
        return NULL;
    }
    /* The child has no use for our end: its write would never fail after our death. */
    (void)fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    /* In a locale that is not UTF-8 gnuplot complains of its degree sign; this program knows no locale itself. */
    (void)setenv("LC_ALL", "C.UTF-8", 1);
    pid_t pid;
    const bool started = start(argv, fileno(script), ends[1], &pid);
    close(ends[1]);
    FILE *stream = fdopen(ends[0], "r");
    char *svg = stream != NULL ? read_all(stream) : NULL;
    if (stream != NULL) {
        fclose(stream);
    } else {
        close(ends[0]);
    }
    if (!started || !ended_well(pid) || svg == NULL || strstr(svg, "</svg>") == NULL) {
        free(svg);
        error_failure(e, 0, "gnuplot could not draw a figure");
        return NULL;
    }
    return svg;
}

char *plot_draw(plot *p, error *e)
{
    if (fclose(p->script) != 0) {
        p->script = NULL;
        error_failure(e, errno, "plot");
        plot_abandon(p);
        return NULL;
    }
    p->script = NULL;
    FILE *script = script_file(p, e);
    char *svg = script != NULL ? run_gnuplot(script, e) : NULL;
    if (script != NULL) {
        fclose(script);
    }
    plot_abandon(p);
    return svg;
}

bool plot_available(void)
{
    const char *const argv[] = {"gnuplot", "--version", NULL};
    pid_t pid;
    return start(argv, -1, -1, &pid) && ended_well(pid);
}

/* POSIX: open_memstream, popen, mkstemp. */
#define _POSIX_C_SOURCE 200809L

#include "plot.h"

#include "../base/leftovers.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

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
    char *text = NULL;
    size_t size = 0;
    FILE *all = open_memstream(&text, &size);
    if (all == NULL) {
        return NULL;
    }
    char block[65536];
    size_t got;
    while ((got = fread(block, 1, sizeof block, stream)) > 0) {
        fwrite(block, 1, got, all);
    }
    if (fclose(all) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

static bool write_script(const plot *p, int file, error *e)
{
    FILE *stream = fdopen(file, "w");
    if (stream == NULL) {
        close(file);
        return error_failure(e, errno, "plot");
    }
    const bool written = fwrite(p->text, 1, p->size, stream) == p->size;
    return (fclose(stream) == 0 && written) || error_failure(e, errno, "plot: its script cannot be written");
}

static char *run_gnuplot(const char *script_path, error *e)
{
    char command[128];
    /* The path is mkstemp's and needs no quoting.
     * In a locale that is not UTF-8 gnuplot complains of its degree sign. */
    snprintf(command, sizeof command, "LC_ALL=C.UTF-8 gnuplot %s", script_path);
    fflush(NULL);
    FILE *stream = popen(command, "r");
    if (stream == NULL) {
        error_failure(e, errno, "gnuplot");
        return NULL;
    }
    char *svg = read_all(stream);
    const int status = pclose(stream);
    if (svg == NULL || status == -1 || !WIFEXITED(status) || WEXITSTATUS(status) != 0 ||
        strstr(svg, "</svg>") == NULL) {
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
    char path[] = "/tmp/iqfoc-plot-XXXXXX";
    const int file = mkstemp(path);
    char *svg = NULL;
    if (file < 0) {
        error_failure(e, errno, "%s", path);
    } else {
        leftovers_add(path);
        if (write_script(p, file, e)) {
            svg = run_gnuplot(path, e);
        }
        unlink(path);
        leftovers_forget(path);
    }
    plot_abandon(p);
    return svg;
}

bool plot_available(void)
{
    return system("gnuplot --version >/dev/null 2>&1") == 0;
}

/*
 * Plots: a gnuplot script written piece by piece, drawn to SVG.
 *
 *     plot p;
 *     plot_begin(&p, 720, 360, e);
 *     plot_data(&p, "curve");  plot_say(&p, "%g %g\n", x, y); ...  plot_data_end(&p);
 *     plot_say(&p, "plot $curve with lines linestyle 1 title 'mean'\n");
 *     char *svg = plot_draw(&p, e);
 *
 * Line styles 1 to 4 are set, in colours that stay apart for every common kind of colour vision; 9 is faint. A
 * page (page.h) shows each colour in a light and a dark variant.
 */
#ifndef SIM_HOST_REPORT_PLOT_H
#define SIM_HOST_REPORT_PLOT_H

#include "../base/error.h"

#include <stdio.h>

#define PLOT_BLUE   "#0072b2" /* linestyle 1 */
#define PLOT_ORANGE "#d55e00" /* 2 */
#define PLOT_GREEN  "#009e73" /* 3 */
#define PLOT_PURPLE "#aa4499" /* 4 */
#define PLOT_FAINT  "#8c8c8c" /* 9 */
#define PLOT_INK    "#333333" /* text, axes */
#define PLOT_GRID   "#e3e3e3"
#define PLOT_BAND   "#f6d9c4" /* area of an uncertainty around linestyle 2 */

typedef struct plot {
    FILE *script;
    char *text;
    size_t size;
} plot;

/* False with *e set when memory runs out. Sizes in pixels at 100 %; the picture scales. */
bool plot_begin(plot *p, int width, int height, error *e);

/* printf into the script. */
void plot_say(plot *p, const char *format, ...) ERROR_PRINTF(2, 3);

/* Data block $name; its lines follow by plot_say. An empty line parts pieces of a curve. */
void plot_data(plot *p, const char *name);
void plot_data_end(plot *p);

/* Runs gnuplot; the SVG as text, to be freed, or NULL with *e set. The plot is used up either way. */
char *plot_draw(plot *p, error *e);

/* Gives up a plot that was begun. */
void plot_abandon(plot *p);

/* Is there a gnuplot on this machine? */
bool plot_available(void);

#endif

/* Contour lines by gnuplot, their values put where they cross a line (contour.h). */
#include "contour.h"

#include <math.h>

enum { GRID_X = 81, GRID_Y = 61 };

static void say_grid(plot *p, const contour_panel *panel, const char *name)
{
    plot_data(p, name);
    for (int row = 0; row < GRID_Y; row++) {
        const double y = panel->y_low + (panel->y_high - panel->y_low) * row / (GRID_Y - 1);
        for (int col = 0; col < GRID_X; col++) {
            const double x = panel->x_low + (panel->x_high - panel->x_low) * col / (GRID_X - 1);
            plot_say(p, "%.6g %.6g %.8g\n", x, y, panel->value(x, y));
        }
        plot_say(p, "\n");
    }
    plot_data_end(p);
}

static void say_values(plot *p, const contour_panel *panel, const char *name)
{
    enum { STEPS = 2000 };
    char block[32];
    snprintf(block, sizeof block, "%s_values", name);
    plot_data(p, block);
    double before = panel->value(panel->from_x, panel->from_y);
    for (int n = 1; n <= STEPS; n++) {
        const double at = (double)n / STEPS;
        const double x = panel->from_x + at * (panel->to_x - panel->from_x);
        const double y = panel->from_y + at * (panel->to_y - panel->from_y);
        const double value = panel->value(x, y);
        const double spacing = 2.0 * panel->level_step;
        const double level = spacing * floor(fmax(before, value) / spacing);
        if (level > fmin(before, value)) {
            char text[32];
            /* "-0" is written as "0". */
            snprintf(text, sizeof text, panel->level_format, fabs(level) < 1e-9 ? 0.0 : level);
            plot_say(p, "%g %g %s\n", x, y, text);
        }
        before = value;
    }
    plot_data_end(p);
}

/* Contour lines with their values in them. */
static void say_contours(plot *p, const contour_panel *panel, const char *name)
{
    say_values(p, panel, name);
    plot_say(p,
             "set contour base\nunset surface\n"
             "set cntrparam levels incremental %g,%g,%g\nset table $%s_lines\nsplot $%s using 1:2:3 notitle\n"
             "unset table\nunset contour\nset xrange [%g:%g]\nset yrange [%g:%g]\n"
             "set style textbox opaque noborder margins 0.4,0.2\nset title \"%s\"\n"
             "set xlabel \"%s\"\nset ylabel \"%s\"\n"
             "plot $%s_lines using 1:2 with lines linestyle 1 linewidth 1.3 notitle, "
             "$%s_values using 1:2:3 with labels boxed font ',11' textcolor rgb '" PLOT_INK "' notitle\n",
             panel->level_low, panel->level_step, panel->level_high, name, name, panel->x_low, panel->x_high,
             panel->y_low, panel->y_high, panel->title, panel->x_label, panel->y_label, name, name);
}

bool contour_pair(plot *p, const contour_panel panel[2], error *e)
{
    if (!plot_begin(p, 620, 330, e)) {
        return false;
    }
    say_grid(p, &panel[0], "left");
    say_grid(p, &panel[1], "right");
    plot_say(p, "set multiplot layout 1,2 margins 0.11,0.975,0.15,0.91 spacing 0.14,0\n");
    say_contours(p, &panel[0], "left");
    say_contours(p, &panel[1], "right");
    plot_say(p, "unset multiplot\n");
    return true;
}

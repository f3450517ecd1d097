/* The map of mean_map.h as a page and a picture. */
#include "mean_map.h"

#include "../report/page.h"

#include <math.h>

static const double limits_percent[] = {1.0, 0.1};
enum { LIMITS = sizeof limits_percent / sizeof limits_percent[0] };

/* Light to strong with the cost; the last is "none". */
static const char *const colours[MEAN_METHODS + 1] = {"#d9ead3", "#a8cfe8", "#f3c98b", "#d98b6a", "#8c8c8c"};

/* One panel as boxes: of each index the runs of ratios for which one method is the answer. */
static void say_boxes(plot *p, const mean_map *map, int load, int limit)
{
    const double half_step = sqrt(map->ratio[1] / map->ratio[0]);
    const double half_index = 0.5 * (map->index[1] - map->index[0]);
    plot_say(p, "$boxes_%d_%d << END_OF_DATA\n", load, limit);
    for (int n = 0; n < MEAN_MAP_INDICES; n++) {
        int first = 0;
        for (int r = 0; r < MEAN_MAP_RATIOS; r++) {
            const mean_method enough = mean_map_enough(map->percent[load][n][r], limits_percent[limit]);
            const bool goes_on = r + 1 < MEAN_MAP_RATIOS && mean_map_enough(map->percent[load][n][r + 1],
                                                                            limits_percent[limit]) == enough;
            if (!goes_on) {
                plot_say(p, "%.5g %.4g %.5g %.5g %.4g %.4g 0x%s\n", map->ratio[r], map->index[n],
                         map->ratio[first] / half_step, map->ratio[r] * half_step, map->index[n] - half_index,
                         map->index[n] + half_index, colours[enough] + 1);
                first = r + 1;
            }
        }
    }
    plot_data_end(p);
}

static void say_panel(plot *p, const mean_map *map, int load, int limit)
{
    plot_say(p, "set title 'load %g %%, error within %g %%'\n", 100.0 * map->load[load],
             limits_percent[limit]);
    plot_say(p, "set ylabel '%s' offset 0.6,0\n", load == 0 ? "modulation index" : "");
    plot_say(p, "set xlabel '%s' offset 0,0.8\n", limit == LIMITS - 1 ? "SFFR" : "");
    plot_say(p, "plot $boxes_%d_%d using 1:2:3:4:5:6:7 with boxxyerror fillcolor rgb variable notitle\n",
             load, limit);
}

/* The key as a panel below: a box of each colour and its meaning. */
static void say_key(plot *p)
{
    static const double left[MEAN_METHODS + 1] = {0.05, 0.235, 0.42, 0.62, 0.84};
    for (int k = 0; k <= MEAN_METHODS; k++) {
        plot_say(p,
                 "set object %d rectangle from screen %g,0.015 to screen %g,0.045 fillcolor rgb '%s' "
                 "fillstyle solid border rgb '" PLOT_INK "'\n"
                 "set label %d '%s' at screen %g,0.03 left textcolor rgb '" PLOT_INK "'\n",
                 k + 1, left[k], left[k] + 0.022, colours[k], k + 1,
                 k == MEAN_METHODS ? "none of these" : mean_method_name((mean_method)k), left[k] + 0.03);
    }
}

static bool draw(page *to, const motor *m, const mean_map *map, error *e)
{
    plot p;
    if (!plot_begin(&p, 980, 640, e)) {
        return false;
    }
    for (int limit = 0; limit < LIMITS; limit++) {
        for (int load = 0; load < MEAN_MAP_LOADS; load++) {
            say_boxes(&p, map, load, limit);
        }
    }
    say_key(&p);
    plot_say(&p,
             "set multiplot layout %d,%d margins 0.08,0.985,0.15,0.955 spacing 0.05,0.1\n"
             "set style fill solid noborder\nset logscale x\nunset grid\nset xrange [2.9:104]\nset yrange "
             "[0:1.03]\nset xtics (3,6,12,25,50,100)\nset ytics 0.25\n",
             LIMITS, MEAN_MAP_LOADS);
    for (int limit = 0; limit < LIMITS; limit++) {
        for (int load = 0; load < MEAN_MAP_LOADS; load++) {
            say_panel(&p, map, load, limit);
            plot_say(&p, "unset object\nunset label\n"); /* the key, drawn with the first panel */
        }
    }
    plot_say(&p, "unset multiplot\n");
    char caption[512];
    snprintf(caption, sizeof caption,
             "%s: the cheapest mean of the dq current whose largest error stays within 1 %% or 0.1 %% of the "
             "rated current, over the switching-to-fundamental frequency ratio and the modulation index.",
             m->name);
    return page_figure(to, &p, "mean-map", caption, e);
}

/* The lowest ratio from which on a method is within the limit at every index. */
static double from_ratio(const mean_map *map, int load, mean_method which, double limit_percent)
{
    double from = INFINITY;
    for (int r = MEAN_MAP_RATIOS - 1; r >= 0; r--) {
        for (int n = 0; n < MEAN_MAP_INDICES; n++) {
            if (map->percent[load][n][r][which] > limit_percent) {
                return from;
            }
        }
        from = map->ratio[r];
    }
    return from;
}

static void say_table(page *to, const mean_map *map)
{
    static const double of_table[] = {1.0, 0.3, 0.1, 0.05};
    static const char *const heads[] = {"\terror within, %",     "\tload, %",
                                        "\tmid-point sample",    "\tlinear correction",
                                        "\tquasi-discrete mean", "\tmean under modulation"};
    page_table_begin(to, heads, 6);
    for (int limit = 0; limit < 4; limit++) {
        for (int load = 0; load < MEAN_MAP_LOADS; load++) {
            page_row_begin(to);
            page_cell(to, true, "%g", of_table[limit]);
            page_cell(to, true, "%g", 100.0 * map->load[load]);
            for (int k = 0; k < MEAN_METHODS; k++) {
                const double from = from_ratio(map, load, (mean_method)k, of_table[limit]);
                page_cell(to, true, isinf(from) ? "-" : "%.3g", from);
            }
            page_row_end(to);
        }
    }
    page_table_end(to);
}

bool mean_map_page(const char *directory, const motor *m, const mean_map *map, error *e)
{
    page p;
    if (!page_begin(
            &p, directory, "Which mean current to use",
            "Mean dq current over a PWM cycle, seen from the turning rotor: what a controller regulates.",
            e)) {
        return false;
    }
    const bool ok = draw(&p, m, map, e);
    page_text(&p, "The lowest SFFR from which a method is within the limit at every modulation index:");
    say_table(&p, map);
    return page_finish(&p, ok, e);
}

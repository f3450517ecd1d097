/* Contour lines of a function of two variables, their values written into them. */
#ifndef SIM_HOST_REPORT_CONTOUR_H
#define SIM_HOST_REPORT_CONTOUR_H

#include "plot.h"

typedef struct contour_panel {
    const char *title, *x_label, *y_label;
    double x_low, x_high, y_low, y_high;
    double level_low, level_step, level_high;
    const char *level_format;
    /* The values are written where the contour lines cross this straight one; every other line has one. */
    double from_x, from_y, to_x, to_y;
    double (*value)(double x, double y);
} contour_panel;

/* Two of them side by side, a whole figure. False with *e set when memory runs out. */
bool contour_pair(plot *p, const contour_panel panel[2], error *e);

#endif

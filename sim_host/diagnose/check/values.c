#include "values.h"

#include "base/sort.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* A DC link may sag or be charged within a recording, but not beyond these of its median. */
static const double LINK_LEAST = 0.01;
static const double LINK_MOST = 10.0;
/* Duties of overmodulation, computed but not yet clipped, and noise of an ADC that measured them. */
static const double DUTY_ROOM = 0.25;
/* Up to this share of rows outside are glitches, which a diagnosis leaves out. */
static const double DUTY_ROWS = 0.01;

static double median_of(const double *x, size_t n)
{
    double *sorted = malloc(n * sizeof *sorted);
    double median = 0.0;
    for (size_t k = 0; sorted && k < n; k++) {
        sorted[k] = x[k];
    }
    if (sorted) {
        sort_ascending(sorted, n);
        median = sorted[n / 2];
    }
    free(sorted);
    return median;
}

static bool check_link(const recording *rec, error *e)
{
    const double *u = rec->u_dc_V;
    if (u == NULL) {
        return true;
    }
    const double median = median_of(u, rec->rows);
    for (size_t k = 0; k < rec->rows; k++) {
        if (!(u[k] > 0.0)) {
            return error_input(e, rec->path, rec->line ? rec->line[k] : 0, 0,
                               "u_dc_V = %g; expected the voltage of the DC link, > 0 V (the median is %g V)",
                               u[k], median);
        }
        if (median > 0.0 && (u[k] < LINK_LEAST * median || u[k] > LINK_MOST * median)) {
            return error_input(e, rec->path, rec->line ? rec->line[k] : 0, 0,
                               "u_dc_V = %g, but the median is %g V; expected %g to %g times the median",
                               u[k], median, LINK_LEAST, LINK_MOST);
        }
    }
    return true;
}

static bool check_duties(const recording *rec, error *e)
{
    double lowest = INFINITY;
    double highest = -INFINITY;
    double beyond = 0.0;
    for (size_t x = 0; rec->duty[0] != NULL && x < 3; x++) {
        for (size_t k = 0; k < rec->rows; k++) {
            const double d = rec->duty[x][k];
            lowest = fmin(lowest, d);
            highest = fmax(highest, d);
            beyond += d < -DUTY_ROOM || d > 1.0 + DUTY_ROOM;
        }
    }
    if (beyond <= DUTY_ROWS * 3.0 * (double)rec->rows) {
        return true;
    }
    const char *why = highest > 100.5 || lowest < -100.5 ? "they look like compare counts"
                      : highest > 1.5                    ? "they look like percent"
                                                         : "they look centred on 0";
    return error_input(e, rec->path, 0, 0,
                       "d_a, d_b and d_c run from %.4g to %.4g: %s; expected duties from 0 to 1", lowest,
                       highest, why);
}

bool check_speed(const recording *rec, error *e)
{
    for (size_t k = 0; k < rec->rows; k++) {
        const double turn = fabs(rec->omega_e_rad_s[k]) * rec->T_s / VEC_TWO_PI;
        if (turn > 0.5) {
            return error_input(e, rec->path, rec->line ? rec->line[k] : 0, 0,
                               "omega_e_rad_s = %g is %.3g electrical periods in a control cycle of %g s; "
                               "expected half a period at most",
                               rec->omega_e_rad_s[k], turn, rec->T_s);
        }
    }
    return true;
}

bool check_values(const recording *rec, error *e)
{
    return check_link(rec, e) && check_duties(rec, e);
}

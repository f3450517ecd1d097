/* Smooths the recorded rotor angle (angle_smooth.h). */
#include "angle_smooth.h"

#include "row_speeds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Least squares of a parabola over the rows first ... last. fit: value at row `at` less its angle, slope per row, and coefficient of
 * rows^2.
 */
static void parabola(const double *angle, size_t first, size_t last, size_t at, double fit[3])
{
    double m[5] = {0.0}; /* moments of the rows */
    double v[3] = {0.0};
    for (size_t k = first; k <= last; k++) {
        const double x = (double)k - (double)at;
        const double y = angle[k] - angle[at];
        double power = 1.0;
        for (size_t n = 0; n < 5; n++) {
            m[n] += power;
            v[n < 3 ? n : 0] += n < 3 ? power * y : 0.0;
            power *= x;
        }
    }
    const double det = m[0] * (m[2] * m[4] - m[3] * m[3]) - m[1] * (m[1] * m[4] - m[3] * m[2]) +
                       m[2] * (m[1] * m[3] - m[2] * m[2]);
    fit[0] = v[0] * (m[2] * m[4] - m[3] * m[3]) - m[1] * (v[1] * m[4] - m[3] * v[2]) +
             m[2] * (v[1] * m[3] - m[2] * v[2]);
    fit[1] = m[0] * (v[1] * m[4] - m[3] * v[2]) - v[0] * (m[1] * m[4] - m[3] * m[2]) +
             m[2] * (m[1] * v[2] - v[1] * m[2]);
    fit[2] = m[0] * (m[2] * v[2] - v[1] * m[3]) - m[1] * (m[1] * v[2] - v[1] * m[2]) +
             v[0] * (m[1] * m[3] - m[2] * m[2]);
    for (size_t n = 0; n < 3; n++) {
        fit[n] /= det;
    }
}

/* The true angle of each row of a stretch by the model, without jumps by a turn. */
static void true_angles(const cycle_row *row, size_t count, const averaged_drive *drive, double *angle)
{
    for (size_t j = 0; j < count; j++) {
        const vec_rotor r = averaged_drive_rotor(drive, &row[j]);
        angle[j] = atan2(r.sin, r.cos);
        if (j > 0) {
            const double expected = angle[j - 1] + row[j - 1].omega_rad_s * row[j - 1].T_s;
            angle[j] -= VEC_TWO_PI * round((angle[j] - expected) / VEC_TWO_PI);
        }
    }
}

static void smooth_stretch(const cycle_row *from, cycle_row *to, size_t count, size_t half,
                           const double *angle)
{
    for (size_t j = 0; j < count; j++) {
        const size_t first = j > half ? j - half : 0;
        const size_t last = j + half < count ? j + half : count - 1;
        if (last - first < 3) {
            continue;
        }
        double fit[3];
        parabola(angle, first, last, j, fit);
        const double c = cos(fit[0]);
        const double s = sin(fit[0]);
        to[j].cos_theta = from[j].cos_theta * c - from[j].sin_theta * s;
        to[j].sin_theta = from[j].cos_theta * s + from[j].sin_theta * c;
        to[j].omega_rad_s = (fit[1] + fit[2]) / from[j].T_s; /* from this row to the next */
        to[j].cos_turn = cos(to[j].omega_rad_s * from[j].T_s);
        to[j].sin_turn = sin(to[j].omega_rad_s * from[j].T_s);
    }
}

bool angle_smooth(fit_data *d, const cycle_row *from, const averaged_drive *drive, size_t half)
{
    diagnose_rows *r = d->rows;
    double *angle = malloc((r->rows + 1) * sizeof *angle);
    bool ok = angle != NULL;
    memcpy(r->row, from, r->rows * sizeof *from);
    for (size_t n = 0; ok && half > 0 && n < r->recording->stretches; n++) {
        const stretch *s = &r->recording->stretch[n];
        true_angles(from + s->first, s->count, drive, angle);
        smooth_stretch(from + s->first, r->row + s->first, s->count, half, angle);
    }
    free(angle);
    ok = ok && rows_place_nodes(r);
    averaged_node *nodes = ok ? realloc(d->nodes, (r->nodes + 1) * sizeof *nodes) : NULL;
    d->nodes = nodes ? nodes : d->nodes;
    return nodes != NULL;
}

#include "speed_from_angle.h"

#include "../base/vector.h"
#include "recording_columns.h"

#include <math.h>

enum { ROWS_AROUND = 17 };

/* The angle of row k from that of row `from`, the nearest way round from row to row. */
static void unwrap(const recording *r, size_t first, size_t count, double *out)
{
    out[0] = 0.0;
    for (size_t j = 1; j < count; j++) {
        const double step = r->theta_e_rad[first + j] - r->theta_e_rad[first + j - 1];
        out[j] = out[j - 1] + step - VEC_TWO_PI * round(step / VEC_TWO_PI);
    }
}

/*
 * The slope at x = at of the parabola that fits y[0 .. n-1] over x = 0 .. n-1 best: in the polynomials that are
 * orthogonal over these points, z = x - (n-1)/2 and z^2 - (n^2-1)/12.
 */
static double slope_at(const double *y, size_t n, double at)
{
    const double centre = 0.5 * (double)(n - 1);
    const double mean_square = ((double)n * (double)n - 1.0) / 12.0;
    double line = 0.0;
    double line_norm = 0.0;
    double bow = 0.0;
    double bow_norm = 0.0;
    for (size_t j = 0; j < n; j++) {
        const double z = (double)j - centre;
        const double p = z * z - mean_square;
        line += z * y[j];
        line_norm += z * z;
        bow += p * y[j];
        bow_norm += p * p;
    }
    const double curvature = n > 2 ? 2.0 * (at - centre) * bow / bow_norm : 0.0;
    return line / line_norm + curvature;
}

bool speed_from_angle(recording *r, const char *path, error *e)
{
    const double most = recording_column_most(COL_OMEGA);
    for (size_t s = 0; s < r->stretches; s++) {
        const stretch *all = &r->stretch[s];
        const size_t n = all->count < ROWS_AROUND ? all->count : ROWS_AROUND;
        for (size_t j = 0; j < all->count; j++) {
            double theta[ROWS_AROUND];
            size_t begin = j > n / 2 ? j - n / 2 : 0;
            begin = begin + n > all->count ? all->count - n : begin;
            unwrap(r, all->first + begin, n, theta);
            const double omega = n < 2 ? 0.0 : slope_at(theta, n, (double)(j - begin)) / r->T_s;
            if (!(fabs(omega) <= most)) {
                return error_input(
                    e, path, 0, 0,
                    "theta_e_rad turns at %.3g rad/s in row %zu, where a cycle is %.3g s; expected at most "
                    "%g rad/s: is t_s in seconds?",
                    omega, all->first + j + 1, r->T_s, most);
            }
            r->omega_e_rad_s[all->first + j] = omega;
        }
    }
    return true;
}

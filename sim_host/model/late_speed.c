/* The speed ahead of its filter (late_speed.h). */
#include "late_speed.h"

#include <math.h>

enum { ROWS_LEAST = 2, ROWS_MOST = 50 };

void late_speed_undo(const double *recorded, size_t n, double T_s, double tau_s, double *true_speed)
{
    const double wide = fmin(fmax(fabs(tau_s) / T_s, ROWS_LEAST), ROWS_MOST);
    const size_t around = (size_t)lround(wide);
    for (size_t j = 0; j < n; j++) {
        const size_t begin = j > around ? j - around : 0;
        const size_t end = j + around < n ? j + around + 1 : n;
        const double count = (double)(end - begin);
        const double middle = 0.5 * (double)(begin + end - 1);
        double mean = 0.0;
        double along = 0.0;
        for (size_t k = begin; k < end; k++) {
            mean += recorded[k] / count;
            along += recorded[k] * ((double)k - middle);
        }
        const double norm = count * (count * count - 1.0) / 12.0;
        const double slope = norm > 0.0 ? along / norm : 0.0; /* per row */
        true_speed[j] = mean + slope * ((double)j - middle + tau_s / T_s);
    }
}

/* A mean from both sides (two_sided.h). */
#include "two_sided.h"

#include <math.h>

void two_sided_mean(double *x, double *work, size_t n, double weight)
{
    const double endless = 1.0 / (1.0 - weight);
    double before = 0.0;
    for (size_t k = 0; k < n; k++) {
        work[k] = before = weight * before + x[k];
    }
    double after = 0.0; /* of the numbers after this one */
    double after_weights = 0.0;
    for (size_t k = n; k-- > 0;) {
        const double before_weights = endless * (1.0 - pow(weight, (double)(k + 1)));
        const double is = x[k];
        x[k] = (work[k] + after) / (before_weights + after_weights);
        after = weight * (after + is);
        after_weights = weight * (after_weights + 1.0);
    }
}

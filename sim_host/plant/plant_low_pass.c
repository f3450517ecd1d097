/* The weights by their recurrence w_n = 1 - n/beta w_(n-1) (plant_low_pass.h). */
#include "plant_low_pass.h"

#include <math.h>

void low_pass_weights(double beta, int terms, double weight[])
{
    /* Upwards an error grows by n/beta, downwards it shrinks by as much. */
    const int up_to = beta < terms ? (int)beta : terms - 1;
    weight[0] = -expm1(-beta);
    for (int n = 1; n <= up_to; n++) {
        weight[n] = 1.0 - n / beta * weight[n - 1];
    }
    /* The start's error, below 1, is gone after m steps: beta^m terms!/(terms + m)! < 1e-16. */
    const int above = up_to + 1 < terms ? terms + 16 + 2 * (int)beta : 0;
    double w = 0.5;
    for (int n = above; n > up_to + 1; n--) {
        w = beta / n * (1.0 - w); /* w_(n-1) */
        if (n <= terms) {
            weight[n - 1] = w;
        }
    }
}

/* Current sensors that are not linear (sensor_nonlinearity.h). */
#include "sensor_nonlinearity.h"

#include <math.h>

/* A nonlinearity of a tenth is removed to 1e-3 of itself. */
enum { UNDO_STEPS = 6 };

bool sensor_nonlinearity_present(const averaged_drive *d)
{
    return d->cubic_A2[0] != 0.0 || d->cubic_A2[1] != 0.0 || d->cubic_A2[2] != 0.0 || d->zone_A != 0.0 ||
           d->ring_A != 0.0 || d->ring_sum_A != 0.0;
}

/* Adds what rings in each channel. A phase that is not measured is minus the sum of the others. */
static void add_ringing(const averaged_drive *d, const cycle_row *row, double y[3])
{
    const int absent = (int)row->missing - (int)MISSING_A;
    double edge[3];
    for (size_t x = 0; x < 3; x++) {
        const double fell = row->history > 0 ? 1.0 - row[-1].no_fall[x] : 1.0;
        edge[x] = fell * exp(-row->fell[x] / d->ring_share);
    }
    const double sum = edge[0] + edge[1] + edge[2];
    double shown = 0.0;
    for (int x = 0; x < 3; x++) {
        edge[x] = x == absent ? 0.0 : d->ring_A * edge[x] + d->ring_sum_A * sum;
        shown += edge[x];
    }
    for (int x = 0; x < 3; x++) {
        y[x] += x == absent ? -shown : edge[x];
    }
}

vec_ab sensor_nonlinearity_error(const averaged_drive *d, const cycle_row *row, vec_ab linear, double *zero)
{
    const double zone_A = fabs(d->zone_A);
    double y[3];
    vec_to_phases(linear, y);
    for (size_t x = 0; x < 3; x++) {
        const double lost = fmin(fmax(y[x], -zone_A), zone_A);
        y[x] = d->cubic_A2[x] * y[x] * y[x] * y[x] - copysign(lost, d->zone_A * y[x]);
    }
    if (d->ring_A != 0.0 || d->ring_sum_A != 0.0) {
        add_ringing(d, row, y);
    }
    *zero = (y[0] + y[1] + y[2]) / 3.0;
    return vec_from_phases(y);
}

vec_ab sensor_nonlinearity_remove(const averaged_drive *d, const cycle_row *row, vec_ab recorded)
{
    vec_ab linear = recorded;
    for (int k = 0; k < UNDO_STEPS; k++) {
        double zero;
        const vec_ab more = sensor_nonlinearity_error(d, row, linear, &zero);
        linear.alpha = recorded.alpha - more.alpha;
        linear.beta = recorded.beta - more.beta;
    }
    return linear;
}

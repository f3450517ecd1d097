/*
 * Current samples that are not linear in the current. Beyond what a linear sensor would show of phase x, y_x, they show
 *
 *     cubic_x y_x^3 - zone sat(y_x / zone) + ring e_x + ring_sum (e_a + e_b + e_c),      e_x = e^(-fell_x / ring_share)
 *
 * sat(x) = x clipped to +-1: a nonlinear transformer or amplifier, and a dead zone at zero. e_x: what still rings of the edge by which
 * leg x fell, a share fell_x of a cycle before the sample; ring_share: the time constant in the same measure. A part couples into all
 * channels. The diagnosis has no name for these; what they do to a current is like a flux map, a dead time or an offset, but no machine
 * moves the sum of three currents, and no offset moves with the duty.
 */
#ifndef SIM_HOST_MODEL_SENSOR_NONLINEARITY_H
#define SIM_HOST_MODEL_SENSOR_NONLINEARITY_H

#include "averaged_drive.h"

bool sensor_nonlinearity_present(const averaged_drive *drive);

/* What they show at a row beyond the linear ones; *zero: in the mean of the three. A cube and a dead zone only of three sensors. */
vec_ab sensor_nonlinearity_error(const averaged_drive *drive, const cycle_row *row, vec_ab linear,
                                 double *zero);

/* What linear ones would have shown of what was recorded. */
vec_ab sensor_nonlinearity_remove(const averaged_drive *drive, const cycle_row *row, vec_ab recorded);

#endif

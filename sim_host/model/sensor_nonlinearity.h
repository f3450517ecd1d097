/*
 * Nonlinear current sensors: beyond what a linear sensor would show of phase x, y_x, they show
 *
 *     cubic_x y_x^3 - zone sat(y_x / zone)
 *
 * sat(x) = x clipped to +-1: a nonlinear transformer or amplifier, and a dead zone at zero. The diagnosis has no
 * name for either; what they do to a current is like a flux map or a dead time, but no machine moves the sum of three
 * currents, and these do.
 */
#ifndef SIM_HOST_MODEL_SENSOR_NONLINEARITY_H
#define SIM_HOST_MODEL_SENSOR_NONLINEARITY_H

#include "averaged_drive.h"

bool sensor_nonlinearity_present(const averaged_drive *drive);

/* What they show beyond the linear ones; *zero: in the mean of the three. Three sensors. */
vec_ab sensor_nonlinearity_error(const averaged_drive *drive, vec_ab linear, double *zero);

/* What linear ones would have shown of what was recorded. */
vec_ab sensor_nonlinearity_remove(const averaged_drive *drive, vec_ab recorded);

#endif

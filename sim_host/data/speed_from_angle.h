/*
 * Computes the speed of a recording without a speed column, as the slope of its angle.
 */
#ifndef SIM_HOST_DATA_SPEED_FROM_ANGLE_H
#define SIM_HOST_DATA_SPEED_FROM_ANGLE_H

#include "recording.h"

/*
 * Fills omega_e_rad_s (allocated by the caller) from theta_e_rad: the slope at each row of a parabola through
 * the unwrapped angle of the 17 rows around it, fewer in a short stretch. A rotor turns by less than half an
 * electrical turn a cycle, so that the nearest way round is the way it went. Stretches and T_s are there.
 *
 * An angle's noise s leaves 0.05 s/T in the speed; an acceleration leaves nothing. False: beyond what a recording may hold, as of
 * time stamps in another unit; `path` is the file's.
 */
bool speed_from_angle(recording *r, const char *path, error *e);

#endif

/*
 * The rotor's angle between its sensor's steps and noise.
 *
 * An angle that is wrong by x rad at both ends of a cycle makes the model err by about psi_f x / L, so that a coarse or noisy angle
 * sensor drowns all else in a machine of low inductance. A rotor does not jump: over some rows its angle is a parabola, and so is
 * the angle that the recording shows less the errors that the model knows. The speed is that parabola's, at the time of the cycle: a
 * speed column that lags is not used then.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ANGLE_SMOOTH_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ANGLE_SMOOTH_H

#include "fit_data.h"

enum { ANGLE_SMOOTH_MOST = 16 };

/*
 * Gives the rows of d the angle and the speed of a parabola over `half` rows to either side (1 to ANGLE_SMOOTH_MOST), fitted to the
 * angle of `from`, as many rows, less the errors that `drive` has for them; half = 0 takes `from` as it is. The table of speeds
 * follows. False: out of memory.
 */
bool angle_smooth(fit_data *d, const cycle_row *from, const averaged_drive *drive, size_t half);

#endif

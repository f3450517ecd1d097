/*
 * Smooths the recorded rotor angle, so that a coarse or noisy angle sensor does not hide other effects.
 *
 * An angle error of x rad at both ends of a cycle makes a prediction error of about psi_f x/L. In a machine of low inductance this
 * error would hide all others. A rotor does not jump: over some rows its true angle is a parabola. The true angle is the recorded one
 * less the angle errors that the model knows. The speed is the slope of that parabola in the cycle, so a speed column that lags has
 * no effect then.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ANGLE_SMOOTH_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ANGLE_SMOOTH_H

#include "fit_data.h"

enum { ANGLE_SMOOTH_MOST = 16 };

/*
 * Gives the rows of d the angle and the speed of a parabola. It is fitted to the angle of `from` (as many rows), less the angle
 * errors of `drive`, over `half` rows to either side (1 to ANGLE_SMOOTH_MOST). half = 0 copies `from`. Updates the table of speeds.
 * False: out of memory.
 */
bool angle_smooth(fit_data *d, const cycle_row *from, const averaged_drive *drive, size_t half);

#endif

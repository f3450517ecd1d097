/*
 * A speed column that is filtered (first order, time constant tau) or delayed by tau:
 *
 *     tau d(recorded)/dt + recorded = true
 *
 * Integrated over a stretch, the angle goes ahead of the recorded speed by tau times the speed's change: by that the two
 * columns tell it. A speed that is late by tau without a filter is the same to first order in tau.
 */
#ifndef SIM_HOST_MODEL_LATE_SPEED_H
#define SIM_HOST_MODEL_LATE_SPEED_H

#include <stddef.h>

/*
 * The true speeds of n consecutive rows. The recorded speed's value and slope at a row are those of the line through the rows
 * within tau of it (2 to 50 of them either way), so that the noise of the column is not raised by tau over T.
 */
void late_speed_undo(const double *recorded, size_t n, double T_s, double tau_s, double *true_speed);

#endif

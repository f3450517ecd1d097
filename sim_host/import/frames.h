/*
 * Angle, speed, currents, voltages and duties of a recording, from whichever frame the log has them in.
 */
#ifndef SIM_HOST_IMPORT_FRAMES_H
#define SIM_HOST_IMPORT_FRAMES_H

#include "conversion.h"

/*
 * Fills all columns but time and run. The vectors in dq are turned by the log's own angle; a speed that it
 * lacks is the slope of that angle. Stretches and T_s are there. False with the error set.
 */
bool frames_fill(const conversion *v);

#endif

/*
 * Swapped phases, signs and directions, and a motor file of another motor. They are looked for only when no
 * set of known effects brings the error near the noise: then the voltage equation is fitted as a plain
 * regression (voltage_equation.h) to the recording as it is and with its columns exchanged, and what holds far
 * better is named. It need not be accurate: an exchange changes what it leaves by factors.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_WIRING_H
#define SIM_HOST_DIAGNOSE_CHECK_WIRING_H

#include "data/motor.h"
#include "data/recording.h"

/* False with one line in *e if it finds exchanged columns that explain the recording, or if the model is
 * `far_off` and the voltage equation holds with values far from the motor file's. */
bool check_wiring(const recording *rec, const motor *m, bool far_off, error *e);

#endif

/*
 * Checks for swapped phases, wrong signs or directions, and a motor file of another motor. It runs only if no set of causes explains
 * the recording, or only one of another motor does. The voltage equation is fitted by plain regression (voltage_equation.h)
 * to the recording as it is and with exchanged columns. An exchange that fits far better is reported.
 */
#ifndef SIM_HOST_DIAGNOSE_CHECK_WIRING_H
#define SIM_HOST_DIAGNOSE_CHECK_WIRING_H

#include "data/motor.h"
#include "data/recording.h"

/* False with one line in *e if it finds exchanged columns that explain the recording, or if the model is
 * `far_off` and the voltage equation holds with values far from the motor file's. */
bool check_wiring(const recording *rec, const motor *m, bool far_off, error *e);

#endif

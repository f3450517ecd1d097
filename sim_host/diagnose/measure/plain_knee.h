/*
 * The knee of the firmware's dead-time model, sat(i / knee), that approximates a dead time fitted by another model.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_PLAIN_KNEE_H
#define SIM_HOST_DIAGNOSE_MEASURE_PLAIN_KNEE_H

#include "diagnose/identify/rows.h"

/* The knee whose lost voltage over currents up to i_peak_A is closest to that of the fitted model with these rows' ripple. */
double plain_knee_A(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A);

/*
 * Whether a compensation adds more to a leg near no current than its dead time takes with this knee. The wrong sign of a simulated current
 * then remains.
 */
bool plain_knee_holds_sign(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A);

#endif

/*
 * The law of dead time that firmware and motor file have, sat(i / knee), for one that was fitted as another.
 */
#ifndef SIM_HOST_DIAGNOSE_TELL_PLAIN_KNEE_H
#define SIM_HOST_DIAGNOSE_TELL_PLAIN_KNEE_H

#include "diagnose/identify/rows.h"

/* The knee of the plain law that loses, over currents up to the rated peak, most nearly what the fitted law
 * loses with the ripple of these rows. */
double plain_knee_A(const averaged_drive *drive, const diagnose_rows *r, double i_peak_A);

#endif

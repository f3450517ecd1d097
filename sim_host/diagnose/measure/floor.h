/*
 * The noise floor: what the sensors' own noise leaves of a one-cycle error, were the model perfect.
 *
 * The noise on a sample enters the error of the cycle that ends there and, with the opposite sign, of the one
 * that begins; a disturbance of the drive enters one only. That is what the filter's gain separates: sensor
 * noise is (1 - gain) of the innovation's variance, whatever else disturbs the drive. Noise of the recorded
 * angle and DC link, seen in their own third differences, is added as it passes through the model.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_FLOOR_H
#define SIM_HOST_DIAGNOSE_MEASURE_FLOOR_H

#include "diagnose/identify/fit_data.h"

/* A rms of the error vector. *sensor_rms_A: of one phase's sensor. No result where memory runs out, which r->no_memory says. */
double measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                     double *sensor_rms_A);

/* The noise of a phase's current, as the fit's innovations leave it; INFINITY if its filter trusts the currents more than the model. */
double measure_phase_noise(const diagnose_rows *r, const fit_state *s);

#endif

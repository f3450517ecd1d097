/*
 * Measuring: one-cycle and free-run errors, the noise floor, and what structure is left.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_H
#define SIM_HOST_DIAGNOSE_MEASURE_H

#include "diagnose_result.h"
#include "fit.h"

#define MEASURE_ALL ((size_t)-1)

/* rms of the one-cycle error vector over rms of the current vector, percent, over held-out (or all) blocks of
 * one group
 * or MEASURE_ALL. */
double measure_one_cycle(const diagnose_rows *r, const averaged_drive *drive, size_t group,
                         bool held_out_only);

/*
 * The floor: what the sensors' own noise leaves of a one-cycle error, A rms of the vector. The noise on a
 * sample enters the error of the cycle that ends there and, with the opposite sign, of the one that begins; a
 * disturbance of the drive enters one only. That is what the filter's gain separates: sensor noise is (1 -
 * gain) of the innovation's variance, whatever else disturbs the drive. Noise of the recorded angle and DC
 * link, seen in their own third differences, is added as it passes through the model.
 */
double measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                     double *sensor_rms_A);

/* Current's rms over held-out rows (A, vector). */
double measure_current(const diagnose_rows *r, size_t group, bool held_out_only);

/* Marks glitches: rows whose innovation stands out of all proportion. Returns how many. */
size_t measure_outliers(fit_data *d, const fit_state *s);

/* Lines and glitches that the extended model leaves. */
bool measure_structure(fit_data *d, const fit_state *s, double excess, diagnosis_structure *found);

/* Fills d->run, the methods and, if wanted, the series. False: out of memory. */
bool measure_runs(const diagnose_rows *r, const fit_state *s, diagnosis *d, bool series);

#endif

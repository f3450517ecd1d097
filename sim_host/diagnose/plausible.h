/*
 * Whether a recording can be diagnosed at all, and if not, what is wrong with it in words that lead to the
 * cable or the column.
 *
 * What shows before any model is fitted (too short, nothing flows, units, angle against speed) is refused
 * first. Swapped phases, signs and directions, and a motor file of another motor are looked for only when no
 * set of known effects brings the error near the noise: then the plain voltage equation is fitted to the
 * recording as it is and with its columns exchanged, and what holds far better is named.
 */
#ifndef SIM_HOST_DIAGNOSE_PLAUSIBLE_H
#define SIM_HOST_DIAGNOSE_PLAUSIBLE_H

#include "../base/error.h"
#include "../data/motor.h"
#include "../data/recording.h"
#include "../model/averaged_drive.h"

/* False with one line in *e. */
bool plausible_columns(const recording *rec, const char *path, const motor *m, error *e);

/* Angle and speed agree: scale and sign. Part of the above. */
bool plausible_angle(const recording *rec, const char *path, const motor *m, error *e);

/* Looks for exchanged columns; false with one line in *e if it finds what explains the recording,
 * or if the model is
 * `far_off` and the plain voltage equation holds with values far from the motor file's. */
bool plausible_wiring(const recording *rec, const motor *m, bool far_off, const char *path, error *e);

/* The fitted values are so far from the file's that it is another motor's. */
bool plausible_motor(const averaged_drive *fitted, const averaged_drive *file, const char *path, error *e);

#endif

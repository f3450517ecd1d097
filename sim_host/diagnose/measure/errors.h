/*
 * The error of one-cycle prediction: what a model is judged by.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_ERRORS_H
#define SIM_HOST_DIAGNOSE_MEASURE_ERRORS_H

#include "diagnose/identify/rows.h"

/* In place of a group: all of them. */
#define MEASURE_ALL ((size_t)-1)

/* rms of the one-cycle error vector over rms of the current vector, percent, over held-out (or all) blocks of
 * one group or MEASURE_ALL. NAN where there is no such row, or no current; and where memory runs out, which r->no_memory says. */
double measure_one_cycle(const diagnose_rows *r, const averaged_drive *drive, size_t group,
                         bool held_out_only);

/* The same over the held-out rows of all groups that no glitch takes part in: what a fit, which has left these out, can answer for. */
double measure_without_glitches(const diagnose_rows *r, const averaged_drive *drive);

/* measure_one_cycle() over held-out rows without the nth correction of rows and later ones, over that with it. */
double measure_gain_of_correction(const diagnose_rows *r, size_t n, const averaged_drive *drive);

/* Current's rms over the same rows (A, vector). */
double measure_current(const diagnose_rows *r, size_t group, bool held_out_only);

#endif

/*
 * The figures per operating point, the error by method, and the series for the pictures.
 */
#ifndef SIM_HOST_DIAGNOSE_MEASURE_RUNS_H
#define SIM_HOST_DIAGNOSE_MEASURE_RUNS_H

#include "diagnose/identify/rows.h"
#include "diagnose/result.h"

/* Fills d->run, the methods and, if wanted, the series, for d's nominal and extended drives. False: out of
 * memory. */
bool measure_runs(const diagnose_rows *r, diagnosis *d, bool series);

/* The open-loop error of all rows, percent of the current; NAN where the simulation gives no number or memory runs out. `run` may be
 * NULL; else it receives the error of each operating point. */
double measure_open_loop(const diagnose_rows *r, const averaged_drive *drive, double run[ROWS_MAX_GROUPS]);

#endif

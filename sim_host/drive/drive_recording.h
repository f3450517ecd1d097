/*
 * The rows of a simulated drive as a recording (interfaces.md): sensor values and firmware commands, in the columns that the scenario
 * selects. It holds no true values.
 */
#ifndef SIM_HOST_DRIVE_DRIVE_RECORDING_H
#define SIM_HOST_DRIVE_DRIVE_RECORDING_H

#include "data/recording.h"
#include "drive_run.h"

/* Collects rows. Zero-initialised, then begun; recording is freed with recording_free. */
typedef struct drive_recording {
    recording recording;
    size_t capacity; /* rows */
    double T_s;
    double begin_s; /* of the present run: runs follow each other */
    size_t first;   /* its first row */
    long run;       /* the last row's */
} drive_recording;

/* Room for all logged cycles of a scenario. False with *e set if there is no memory. */
bool drive_recording_begin(drive_recording *r, const scenario *s, double T_s, error *e);

/* When the first row of the next run will stand. */
double drive_recording_next_s(const drive_recording *r);

/* Time of the first row of run n (from 0) of a scenario, up to rounding. */
double drive_recording_run_s(const scenario *s, size_t n, double T_s);

/* A log for drive_run. */
drive_log drive_recording_log(drive_recording *r);

#endif

/*
 * The recording (interfaces.md, "The recording: CSV") as columns of doubles.
 *
 * Columns are in the file's units. A column that the file lacks is NULL; the reader fills i_c from -a-b,
 * and nothing else. A gap of more than 1.5 T in t_s, or a change of `run`, ends a stretch.
 */
#ifndef SIM_HOST_DATA_RECORDING_H
#define SIM_HOST_DATA_RECORDING_H

#include "../base/error.h"
#include "../base/vector.h"
#include "pwm_updates.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct stretch {
    size_t first; /* row */
    size_t count; /* rows, >= 1 */
    long run;     /* the `run` column's value, 0 if it is absent */
} stretch;

typedef struct recording {
    const char *path; /* where it was read from, for messages; borrowed from the caller; NULL: made here */
    size_t rows;
    double *t_s;           /* required */
    double *i_A[3];        /* required; i_A[2] is filled in when absent */
    double *theta_e_rad;   /* required, as recorded (wrapped or not) */
    double *omega_e_rad_s; /* the slope of theta_e_rad when absent */
    double *u_V[3];        /* commanded mean phase-to-star-point voltages, or NULL */
    double *duty[3];       /* high-side duty cycles, or NULL; u_V or duty is there */
    double *u_dc_V;        /* there if duty is */
    double *i_mid_A[3];    /* all three or none; [2] is filled in when absent */
    long *run;             /* or NULL */
    double *theta_mech_rad;
    double *temp_C;
    long *line;         /* the line in the file of each row, for messages */
    bool i_c_measured;  /* false: i_A[2] was filled in */
    bool omega_derived; /* omega_e_rad_s was filled in */
    bool pwm_stated;    /* the comments say how commands reach the PWM: pwm */
    pwm_updates pwm;
    size_t stretches;
    stretch *stretch;
    double T_s; /* control cycle: median step of t_s within stretches; of stamps of few decimals, the mean */
} recording;

/*
 * Reads a plain CSV file (or gzip, recognised by its first bytes); "-" is stdin. Refuses with file, line and
 * column: all missing required columns at once, a field that is no finite number, a row of another length, no
 * rows, time that does not rise within a run. The column named is the character (from 1) at which the field starts in
 * its line.
 *
 * Unknown columns are ignored, and so is an optional group that is not whole: mid-point currents of one
 * phase, two duties in addition to three voltages, duties without u_dc_V in addition to voltages. On failure *r is empty.
 */
bool recording_read(const char *path, recording *r, error *e);

/*
 * The same of `count` columns of `rows` numbers in memory, which are copied; the values of `run` are whole numbers. `path`
 * is what messages call it, and is borrowed; they name the row, from 1, in place of a line. On failure *r is empty.
 */
bool recording_make(recording *r, const char *path, size_t rows, size_t count, const char *const *name,
                    const double *const *value, error *e);

/*
 * Fills stretch, stretches and T_s (0 if no two rows are consecutive) from t_s and run; the reader has done
 * so. False: out of memory.
 */
bool recording_find_stretches(recording *r);

/*
 * Writes the columns that are there, with enough digits that reading gives the same doubles; each line of the
 * comment (may be NULL) behind "# ". i_c is left out unless i_c_measured, so that the file does not claim a
 * third sensor.
 */
bool recording_write(const char *path, const recording *r, const char *comment, error *e);

void recording_free(recording *r);

/* Whether there are three current sensors: a third column that is only minus the sum of the others, rounded,
 * tells nothing of its own. */
bool recording_three_sensors(const recording *r);

/* The recorded current of row k, stationary frame. */
vec_ab recording_current(const recording *r, size_t k);

/* Mean phase-to-star-point voltages of row k: u_V if recorded, else (d_x - mean d) * u_dc. */
void recording_voltage(const recording *r, size_t k, double u_V[3]);
/* The latter. */
void recording_commanded(const double duty[3], double u_dc_V, double u_V[3]);

#endif

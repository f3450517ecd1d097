/*
 * Prepares a recording for the averaged drive: one cycle_row per row, cut into blocks that are fitted or held out.
 *
 * A block is inside one stretch. Its observer starts again, so that nothing of a held-out block affects a fitted one. Three of ten
 * blocks are held out, and at least one of three, spread so that each operating point is in both parts. A group is an operating point
 * (a run). Noise and weight belong to a group, and robust intervals count groups.
 */
#ifndef SIM_HOST_DIAGNOSE_IDENTIFY_ROWS_H
#define SIM_HOST_DIAGNOSE_IDENTIFY_ROWS_H

#include "data/motor.h"
#include "data/recording.h"
#include "model/averaged_drive.h"
#include "model/modulator.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

enum {
    ROWS_HISTORY = 2, /* first rows of a stretch, which only feed the delayed voltages */
    ROWS_MAX_GROUPS = 48,
    ROWS_CORRECTIONS = 4,
    CORRECTION_VALUES = 2
};

typedef struct row_block {
    size_t first, count;
    size_t group;
    size_t stretch;
    bool held_out;
} row_block;

/* A cause that the columns or single rows show without a fit, and the rows before they were corrected for it. */
typedef struct row_correction {
    cause_id cause;
    double value[CORRECTION_VALUES], low[CORRECTION_VALUES],
        high[CORRECTION_VALUES]; /* 95 %, in the order of causes.def */
    cycle_row *before;           /* the rows before the correction */
} row_correction;

typedef struct diagnose_rows {
    const recording *recording;
    double T_s;
    size_t rows;
    cycle_row *row;
    unsigned char *outlier; /* set by the fit: a glitch that would disturb every estimate */
    modulator modulator;    /* of the edges; without duties, as chosen (modulator_choice.h) */
    size_t corrections;
    row_correction correction[ROWS_CORRECTIONS]; /* in the order of correction */
    /* The rows before their angle was smoothed (angle_smooth.h), or NULL; and over how many rows to either side it was. */
    cycle_row *rough;
    size_t smooth_half;
    size_t nodes;
    double *node_omega_rad_s;
    size_t blocks;
    row_block *block;
    size_t clipped; /* rows at the end of a current sensor's range: no block holds one (row_clips.h) */
    size_t groups;
    long group_run[ROWS_MAX_GROUPS]; /* the `run` of each group */
    sensor_set sensors;              /* which currents were measured */
    pwm_updates pwm;                 /* how commands reach the PWM, and which currents are measured */
    bool noise_shows;                /* some row has a u_noise_V (row_noise.h) */
    bool mech_known;                 /* the revolution is known across stretches */
    bool temperature_known;
    double span_s; /* from the recording's first row to its last */
    double omega_max_rad_s, i_peak_A, u_rms_V;
    double noise_A; /* of a phase's current, at the quietest operating point */
    double u_resolution_V;
    bool *no_memory; /* set if a measure runs out of memory: its result is invalid. NULL: not used */
} diagnose_rows;

/* The noise of one phase's current by that of a vector, as noise_A is: a phase without a sensor has the noise of the other two. */
static inline double rows_phase_noise(double noise_A, missing_phase missing, int x)
{
    const bool own = x != (int)missing - (int)MISSING_A;
    return missing == MISSING_NONE ? noise_A : noise_A * sqrt(own ? 0.75 : 1.5);
}

/* Notes that memory ran out in a measure. */
static inline void rows_note_no_memory(const diagnose_rows *r)
{
    if (r->no_memory) {
        *r->no_memory = true;
    }
}

/* Whether all three sensors show: in the currents' sum, or from sector to sector. Of two the third is none. */
static inline bool rows_show_three(const diagnose_rows *r)
{
    return r->sensors != SENSORS_TWO;
}

/* Fills in whose current each row has not measured, by r->sensors and r->pwm. */
void rows_find_missing(diagnose_rows *r);

/* False with *e set if memory runs out or no block can be cut. */
bool rows_prepare(diagnose_rows *r, const recording *rec, const motor *m, error *e);

void rows_free(diagnose_rows *r);

/* The table of the exact step for a drive, one entry per node in use. Caller frees. NULL: no memory. */
averaged_node *rows_nodes(const diagnose_rows *r, const averaged_drive *drive);
/* Fills a table of r->nodes entries. */
void rows_nodes_fill(const diagnose_rows *r, const averaged_drive *drive, averaged_node *nodes);

/* Turns the mechanical angle of one stretch by an angle. */
void rows_turn_mechanical(diagnose_rows *r, size_t stretch, double angle_rad);

#endif

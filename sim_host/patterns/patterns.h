/*
 * Optimal pulse patterns: switching angles of least current distortion over the modulation index, for `iqfoc patterns`
 * (docs/patterns.md).
 *
 * The modulation index is the amplitude of the fundamental over that of six-step. The frequency rises with the index, as at constant
 * flux. With a motor the flux is that of the rated current on the q axis, and the distortion is that of the current over
 * the rated one; without one it is that of the flux over its fundamental.
 */
#ifndef SIM_HOST_PATTERNS_PATTERNS_H
#define SIM_HOST_PATTERNS_PATTERNS_H

#include "base/error.h"
#include "base/json.h"
#include "data/motor.h"
#include "pattern_shape.h"

#include <stdio.h>

enum {
    PATTERNS_ROWS = 70,
    PATTERNS_ROWS_PER_INDEX = 100,
    PATTERNS_PULSES_LEAST = 3,
    PATTERNS_PULSES_MOST = 2 * PATTERN_ANGLES_MOST + 1,
    PATTERNS_RESULTS_MOST = PATTERN_ANGLES_MOST /* one for each number of pulses */
};

/* Index of a row: 0.3, 0.31, ..., 0.99. At 1 no pattern is left but six-step. */
double patterns_index(int row);

/*
 * Index that a machine without saliency needs, at its nominal DC link. w: electrical speed, rad/s; currents as shares of the rated peak.
 */
double patterns_index_of(const motor *m, double w, double i_d, double i_q);

typedef struct patterns_request {
    const motor *m;     /* or NULL */
    int pulses;         /* of a leg in a turn; odd */
    double on_time_s;   /* least time between the edges of a leg at its output */
    double dead_time_s; /* the least time between commanded edges is longer by it */
    double six_step_Hz; /* fundamental frequency at index 1; 0: the motor's at its nominal DC link, or none */
} patterns_request;

typedef struct patterns_row {
    pattern_shape shape;
    bool joined;       /* with the next row: halfway between their angles lies a pattern as good as theirs */
    double distortion; /* share of the rated current, or of the fundamental flux */
    double space_vectors; /* the same of space vectors with as many pulses; NAN above their linear range */
} patterns_row;

typedef struct patterns_result {
    patterns_request asked; /* six_step_Hz as it was used */
    pattern_weight weight;
    double load_angle_rad; /* of the stator flux from the d axis; 0 without a motor */
    double unit;           /* rated distortion over that of the flux */
    int rows;              /* from 0.3 on, as far as the least times permit */
    int jumps;             /* rows but the last that are not joined */
    double index_error;    /* of the index halfway between joined rows, the largest */
    patterns_row row[PATTERNS_ROWS];
} patterns_result;

/* False: a request that leaves no room for the edges, or no memory. */
bool patterns_find(const patterns_request *asked, patterns_result *result, error *e);

/* What follows shows `count` results that differ in their pulses. */

/* A new reference; NULL: out of memory. */
json_t *patterns_json(const patterns_result *r, size_t count);

void patterns_print(const patterns_result *r, size_t count, FILE *out);

/* DIRECTORY/iqfoc_pattern.h: the tables for iqfoc/pattern.h. */
bool patterns_header(const patterns_result *r, size_t count, const char *directory, error *e);

/* DIRECTORY/index.html. */
bool patterns_page(const patterns_result *r, size_t count, const char *directory, error *e);

#endif

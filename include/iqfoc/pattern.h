/*
 * Modulator by pulse pattern: the switching edges of each leg in a control cycle, from the angles that `iqfoc patterns` computes
 * (docs/patterns.md). For drives with 3 to 15 pulses per electrical period.
 *
 * A table has one row per modulation index. The index is the amplitude of the voltage's fundamental over that of six-step. A row has
 * the switching angles of a leg in the first quarter of a turn; without any, it is six-step. Symmetry gives the others; u is the leg's
 * level at angle x in turns:
 *
 *     u(1/2 - x) = u(x)        u(1/2 + x) = -u(x)        fundamental: sin(x), legs b and c 1/3 and 2/3 of a turn later
 *
 * The edges of a cycle are at the switching angles that the voltage's angle passes in the cycle. The modulator needs angle and index
 * at the cycle's start only. The voltage follows the angle within the cycle, so there is no delay of half a cycle to correct.
 *
 *     iqfoc_pattern_step(&modulator, u_angle, turns, iqfoc_pattern_index(u, u_dc_inverse), &edges);
 *
 * The caller owns the modulator; one context at a time may call its functions.
 */
#ifndef IQFOC_PATTERN_H
#define IQFOC_PATTERN_H

#include "error.h"
#include "vector.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_PATTERN_ANGLES_MAX 7
#define IQFOC_PATTERN_ROWS_MAX   100

/*
 * Largest movement of the angle in a cycle: 1/8 turn. It touches at most two quarters of a turn: 7 edges in each and one between, 15
 * edges.
 */
#define IQFOC_PATTERN_SPEED_MAX INT32_C(2097152)

/* Most edges of a leg in a cycle: those 15, and one that the least time has delayed from the cycle before. */
#define IQFOC_PATTERN_EDGES_MAX 16

/* Longest time since an edge that a modulator counts, and so the largest value of `least`: cycles in IQ24. */
#define IQFOC_PATTERN_TIME_MAX IQ24(8.0)

/* Switching angles at one index. */
typedef struct iqfoc_pattern_row {
    int32_t start;                          /* level of the leg after angle 0: 1 high, -1 low */
    int32_t joined;                         /* 1: interpolate to the next row; 0: the angles jump */
    iq24_t angle[IQFOC_PATTERN_ANGLES_MAX]; /* turns, not falling, 0 ... 1/4; unused ones are 0 */
} iqfoc_pattern_row_t;

/* A table, as `iqfoc patterns` writes it. Row n is for the index index_low + n/rows_per_index. */
typedef struct iqfoc_pattern {
    const iqfoc_pattern_row_t *row;
    int32_t rows;          /* 1 ... IQFOC_PATTERN_ROWS_MAX; the last one is not joined */
    int32_t angles;        /* of a row: 0 ... IQFOC_PATTERN_ANGLES_MAX */
    iq24_t index_low;      /* 0 ... 1 */
    iq24_t rows_per_index; /* 1 ... 100 */
} iqfoc_pattern_t;

/* The angles that a cycle uses: those of a row, or interpolated between two rows. */
typedef struct iqfoc_pattern_shape {
    int32_t start;
    iq24_t angle[IQFOC_PATTERN_ANGLES_MAX];
} iqfoc_pattern_shape_t;

typedef struct iqfoc_pattern_leg {
    int32_t level; /* at the end of the last cycle: 1 high, -1 low */
    iq24_t since;  /* from the last edge to that end: cycles, held to 0 ... IQFOC_PATTERN_TIME_MAX */
} iqfoc_pattern_leg_t;

/*
 * Set by iqfoc_pattern_init. To take over from another modulator, set leg[] to the present levels and the times since the last edges.
 */
typedef struct iqfoc_pattern_modulator {
    const iqfoc_pattern_t *table;
    iq24_t least; /* least time between two edges of a leg: cycles, 0 ... IQFOC_PATTERN_TIME_MAX */
    int32_t row;  /* of the last cycle */
    iqfoc_pattern_leg_t leg[3]; /* a, b, c */
} iqfoc_pattern_modulator_t;

/* One leg in one cycle. Each edge changes the level. */
typedef struct iqfoc_pattern_edges {
    int32_t level;                           /* at the cycle's start: 1 high, -1 low */
    int32_t edges;                           /* 0 ... IQFOC_PATTERN_EDGES_MAX */
    iq24_t instant[IQFOC_PATTERN_EDGES_MAX]; /* rising; cycles from the cycle's start: 0 ... 1, 1 excluded */
    iq24_t high;                             /* share of the cycle that the leg is high: 0 ... 1, exact */
} iqfoc_pattern_edges_t;

/*
 * Checks a table and a least time, and sets all legs low without a recent edge. IQFOC_ERROR_NULL: a pointer is missing, the
 * table's row included. IQFOC_ERROR_PATTERN: a value is out of its range, the angles of a row fall, or the starts of two joined rows
 * differ. The modulator keeps the table's address. Call it once, before the drive runs.
 */
iqfoc_error_t iqfoc_pattern_init(iqfoc_pattern_modulator_t *modulator, const iqfoc_pattern_t *table,
                                 iq24_t least);

/*
 * The modulation index of a voltage vector, u pi/(2 u_dc). u: its length in per unit, 0 ... 32. u_dc_inverse: 1/u_dc of the measured
 * link, 0 < u_dc_inverse <= 2. The result is at most 101, without overflow; the modulator limits it to its table. Largest error for a
 * result up to 1: 1.7 LSB. Any context.
 */
static inline iq24_t iqfoc_pattern_index(iq24_t u, iq24_t u_dc_inverse)
{
    return iq24_mul_round(iq24_mul_round(u, u_dc_inverse), IQ24(1.57079632679489661923));
}

/*
 * The angles at an index, by linear interpolation between two rows; an index outside the table is taken as its end. If the two rows
 * are not joined, it takes the row on the side of the last call, until the index is within a quarter of the distance to the other
 * row. Rounded down, so that angles stay in order. index: any. Largest error against the line between the rows: 1.2 LSB.
 */
iqfoc_pattern_shape_t iqfoc_pattern_shape_at(iqfoc_pattern_modulator_t *modulator, iq24_t index);

/*
 * The edges of a cycle, for each leg.
 *
 * angle: of the voltage's fundamental at the cycle's start: IQ24 turns from the axis of phase A, any (the low 24 bits count). turns:
 * the angle's movement in the cycle, either sign; held to +-IQFOC_PATTERN_SPEED_MAX. index: any, as above. edges: legs a, b, c.
 *
 * If an edge comes less than `least` after the leg's last one, it is delayed until `least` is over, into the next cycle if necessary.
 * If the pattern returns to the old level before that, both edges are dropped. So a jump of angle or index makes no short pulse.
 * Largest error of a time, of 200000 cycles drawn, against the table's angles: 0.5 LSB, and 1.5 LSB over the movement in turns.
 *
 * Range: the time of an edge is its distance in angle over the movement. The distance is below the movement, and that is at most 1/8
 * turn, so the quotient is at most 1 - 2^-21 and rounds to less than 1. Times and ages are within +-16 cycles.
 */
void iqfoc_pattern_step(iqfoc_pattern_modulator_t *modulator, iq24_t angle, iq24_t speed, iq24_t index,
                        iqfoc_pattern_edges_t edges[3]);

/* Deprecated name of version 0.1. The next version has only the name above. */
#define IQFOC_PATTERN_TURNS_MAX IQFOC_PATTERN_SPEED_MAX

#ifdef __cplusplus
}
#endif

#endif

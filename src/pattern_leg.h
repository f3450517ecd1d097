/* Parts that the modulators by pulse pattern share: a leg's output follows the pattern's level with a least time between edges. */
#ifndef IQFOC_SRC_PATTERN_LEG_H
#define IQFOC_SRC_PATTERN_LEG_H

#include "iqfoc/pattern.h"

#define PATTERN_HALF_TURN    INT32_C(8388608)
#define PATTERN_QUARTER_TURN INT32_C(4194304)
#define PATTERN_EIGHTH_TURN  INT32_C(2097152)
#define PATTERN_THIRD_TURN   INT32_C(5592405)

/* ---- The rows at an index ---- */

typedef struct {
    const iqfoc_pattern_row_t *row;
    const iqfoc_pattern_row_t *next;
    iq24_t
        part; /* of the way to the next one: 0 ... 1, 1 excluded; negative beyond the row: pattern_trajectory.c */
} pattern_rows_t;

/*
 * The place of an index: rows from the first one. Range: index less index_low is within 0 ... 1, so that it is within 0 ... 100; it is held
 * to the last row.
 */
static inline iq24_t pattern_place(const iqfoc_pattern_t *table, iq24_t index)
{
    const iq24_t above = iq24_clamp(index, table->index_low, IQ24_ONE) - table->index_low;
    return iq24_min(iq24_mul_round(above, table->rows_per_index), (table->rows - 1) * IQ24_ONE);
}

static inline pattern_rows_t pattern_rows_at(iqfoc_pattern_modulator_t *modulator, iq24_t place)
{
    const iqfoc_pattern_t *table = modulator->table;
    int32_t n = iq24_asr32(place, IQ24_FRACTION_BITS);
    const iq24_t part = place & (IQ24_ONE - 1);
    int32_t next = part != 0 ? n + 1 : n;
    /*@ assert pattern_row: 0 <= n <= next < table->rows; */
    if (table->row[n].joined == 0) {
        const iq24_t change = modulator->row <= n ? IQ24(0.75) : IQ24(0.25);
        n = part >= change ? next : n;
        next = n;
    }
    modulator->row = n;
    const pattern_rows_t rows = {&table->row[n], &table->row[next], part};
    return rows;
}

/* floor(a + part (b - a)) for whole a: it keeps the order of angles, as a line between ordered ends does. */
static inline iq24_t pattern_angle(const pattern_rows_t *rows, int32_t k)
{
    const iq24_t angle = rows->row->angle[k];
    return angle + iq24_mul_trunc(rows->part, rows->next->angle[k] - angle);
}

/* ---- A leg ---- */

typedef struct {
    iqfoc_pattern_edges_t *out;
    iq24_t least;
    int32_t wanted; /* the pattern's level */
    iq24_t since;   /* the time of its last change: cycles */
    int32_t level;  /* the output's */
    iq24_t last;    /* the time of its last edge: negative in an earlier cycle */
    int32_t edges;  /* of out */
    iq24_t high;
} pattern_leg_t;

static inline pattern_leg_t pattern_leg_begin(const iqfoc_pattern_leg_t *state, iq24_t least, int32_t wanted,
                                              iqfoc_pattern_edges_t *out)
{
    const iq24_t high = state->level > 0 ? IQ24_ONE : 0;
    const pattern_leg_t leg = {out, least, wanted, 0, state->level, -state->since, 0, high};
    out->level = state->level;
    return leg;
}

/* A cycle without an edge. */
static inline void pattern_leg_stay(iqfoc_pattern_leg_t *state, iqfoc_pattern_edges_t *out)
{
    out->level = state->level;
    out->edges = 0;
    out->high = state->level > 0 ? IQ24_ONE : 0;
    state->since = iq24_min(state->since + IQ24_ONE, IQFOC_PATTERN_TIME_MAX);
}

/* The output follows the pattern's level, if that is possible before the time `end`. */
static inline void pattern_leg_follow(pattern_leg_t *leg, iq24_t end)
{
    const iq24_t instant = iq24_max(leg->since, leg->last + leg->least);
    if (leg->level != leg->wanted && instant < end) {
        /*@ assert pattern_edges: 0 <= leg->edges < 16; */
        leg->out->instant[leg->edges] = instant;
        leg->edges++;
        leg->high += leg->wanted * (IQ24_ONE - instant);
        /*@ assert pattern_high: 0 <= leg->high <= 16777216; */
        leg->level = leg->wanted;
        leg->last = instant;
    }
}

static inline void pattern_leg_end(pattern_leg_t *leg, iqfoc_pattern_leg_t *state)
{
    pattern_leg_follow(leg, IQ24_ONE);
    leg->out->edges = leg->edges;
    leg->out->high = leg->high;
    state->level = leg->level;
    state->since = iq24_min(IQ24_ONE - leg->last, IQFOC_PATTERN_TIME_MAX);
}

#endif

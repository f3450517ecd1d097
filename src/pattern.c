/* Modulator by pulse pattern (include/iqfoc/pattern.h). */
#include "iqfoc/pattern.h"

#include "iqfoc/iq24_math.h"

#include "pattern_leg.h"

#include <stddef.h>

/* ---- The table ---- */

static bool row_fits(const iqfoc_pattern_t *table, const iqfoc_pattern_row_t *row)
{
    iq24_t lowest = 0;
    for (int32_t k = 0; k < table->angles; k++) {
        if (!iq24_within(row->angle[k], lowest, PATTERN_QUARTER_TURN)) {
            return false;
        }
        lowest = row->angle[k];
    }
    return (row->start == 1 || row->start == -1) && iq24_within(row->joined, 0, 1);
}

static bool table_fits(const iqfoc_pattern_t *table)
{
    if (!iq24_within(table->rows, 1, IQFOC_PATTERN_ROWS_MAX) ||
        !iq24_within(table->angles, 0, IQFOC_PATTERN_ANGLES_MAX) ||
        !iq24_within(table->index_low, 0, IQ24_ONE) ||
        !iq24_within(table->rows_per_index, IQ24_ONE, IQ24(100.0))) {
        return false;
    }
    const int32_t last = table->rows - 1;
    for (int32_t n = 0; n <= last; n++) {
        const iqfoc_pattern_row_t *row = &table->row[n];
        if (!row_fits(table, row) || (row->joined != 0 && (n == last || row[1].start != row->start))) {
            return false;
        }
    }
    return true;
}

iqfoc_error_t iqfoc_pattern_init(iqfoc_pattern_modulator_t *modulator, const iqfoc_pattern_t *table,
                                 iq24_t least)
{
    if (modulator == NULL || table == NULL || table->row == NULL) {
        return IQFOC_ERROR_NULL;
    }
    if (!table_fits(table) || !iq24_within(least, 0, IQFOC_PATTERN_TIME_MAX)) {
        return IQFOC_ERROR_PATTERN;
    }
    const iqfoc_pattern_leg_t low = {-1, IQFOC_PATTERN_TIME_MAX};
    const iqfoc_pattern_modulator_t made = {table, least, 0, {low, low, low}};
    *modulator = made;
    return IQFOC_OK;
}

iqfoc_pattern_shape_t iqfoc_pattern_shape_at(iqfoc_pattern_modulator_t *modulator, iq24_t index)
{
    const pattern_rows_t rows = pattern_rows_at(modulator, pattern_place(modulator->table, index));
    iqfoc_pattern_shape_t shape = {rows.row->start, {0}};
    for (int32_t k = 0; k < modulator->table->angles; k++) {
        shape.angle[k] = pattern_angle(&rows, k);
    }
    return shape;
}

/* ---- The edges of a turn, numbered from angle 0: 2 angles + 1 in each half ---- */

static iq24_t edge_angle(const iqfoc_pattern_shape_t *shape, int32_t angles, int32_t edge)
{
    const int32_t in_half = 2 * angles + 1;
    const iq24_t half = edge >= in_half ? PATTERN_HALF_TURN : 0;
    const int32_t k = edge >= in_half ? edge - in_half : edge;
    iq24_t in_first = 0;
    if (k > angles) {
        in_first = PATTERN_HALF_TURN - shape->angle[2 * angles - k];
    } else if (k > 0) {
        in_first = shape->angle[k - 1];
    }
    return half + in_first;
}

/* The last edge at or before x, 0 <= x < 1. */
static int32_t edge_before(const iqfoc_pattern_shape_t *shape, int32_t angles, iq24_t x)
{
    const int32_t first = x >= PATTERN_HALF_TURN ? 2 * angles + 1 : 0;
    const iq24_t y = x >= PATTERN_HALF_TURN ? x - PATTERN_HALF_TURN : x;
    int32_t passed = 0;
    for (int32_t k = 0; k < angles; k++) {
        passed += shape->angle[k] <= y ? 1 : 0;
        passed += PATTERN_HALF_TURN - shape->angle[k] <= y ? 1 : 0;
    }
    return first + passed;
}

/* ---- One leg ---- */

static void step_leg(iqfoc_pattern_leg_t *state, const iqfoc_pattern_shape_t *shape, int32_t angles,
                     iq24_t least, iq24_t x, iq24_t speed, iqfoc_pattern_edges_t *out)
{
    const int32_t most = 4 * angles + 1;
    const iq24_t movement = speed < 0 ? -speed : speed;
    int32_t edge = edge_before(shape, angles, x);
    /* Even edges have the level of the start. */
    pattern_leg_t leg = pattern_leg_begin(state, least, edge % 2 == 0 ? shape->start : -shape->start, out);
    while (true) {
        /* Forward, the next edge is passed; backward, the last one. */
        const int32_t next = edge == most ? 0 : edge + 1;
        const iq24_t passed = edge_angle(shape, angles, speed < 0 ? edge : next);
        const iq24_t distance = (speed < 0 ? x - passed : passed - x) & (IQ24_ONE - 1);
        if (distance >= movement) {
            break;
        }
        const iq24_t at = iq24_div(distance, movement);
        /*@ assert pattern_time: 0 <= at <= 16777215; */
        pattern_leg_follow(&leg, at);
        leg.wanted = -leg.wanted;
        leg.since = at;
        if (speed < 0) {
            edge = edge == 0 ? most : edge - 1;
        } else {
            edge = next;
        }
    }
    pattern_leg_end(&leg, state);
}

void iqfoc_pattern_step(iqfoc_pattern_modulator_t *modulator, iq24_t angle, iq24_t speed, iq24_t index,
                        iqfoc_pattern_edges_t edges[3])
{
    const iqfoc_pattern_shape_t shape = iqfoc_pattern_shape_at(modulator, index);
    const int32_t angles = modulator->table->angles;
    const iq24_t movement = iq24_clamp(speed, -IQFOC_PATTERN_SPEED_MAX, IQFOC_PATTERN_SPEED_MAX);
    /* The fundamental is a sine of the pattern's angle; the voltage's angle is that of a cosine. */
    const iq24_t a = (angle & (IQ24_ONE - 1)) + PATTERN_QUARTER_TURN;
    const iq24_t x[3] = {a, a - PATTERN_THIRD_TURN, a + PATTERN_THIRD_TURN};
    for (int32_t k = 0; k < 3; k++) {
        step_leg(&modulator->leg[k], &shape, angles, modulator->least, x[k] & (IQ24_ONE - 1), movement,
                 &edges[k]);
    }
}

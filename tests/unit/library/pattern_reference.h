/*
 * A pulse pattern by its definition, in double, for the tests of iqfoc/pattern.h and iqfoc/pattern_control.h: tables, levels and edges from
 * the two symmetries. Angles are in turns.
 */
#ifndef TESTS_UNIT_PATTERN_REFERENCE_H
#define TESTS_UNIT_PATTERN_REFERENCE_H

#include "iqfoc/pattern.h"
#include "reference.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 70, EDGES = 4 * IQFOC_PATTERN_ANGLES_MAX + 2 };

/* ---- Tables ---- */

static iqfoc_pattern_row_t rows[ROWS];
static iqfoc_pattern_t table = {rows, ROWS, 1, IQ24(0.3), IQ24(100.0)};

/* Three pulses: the index determines the angle, index = start (1 - 2 cos angle). */
static inline void three_pulses(int32_t start)
{
    table.angles = 1;
    for (int n = 0; n < ROWS; n++) {
        memset(&rows[n], 0, sizeof rows[n]);
        rows[n].start = start;
        rows[n].joined = n + 1 < ROWS;
        rows[n].angle[0] = to_iq24(acos((1.0 - start * (0.3 + 0.01 * n)) / 2.0) / TWO_PI);
    }
}

static inline int rising(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Rows of any angles; those with the same start are joined. */
static inline void drawn_table(uint64_t *seed)
{
    table.angles = 1 + (int32_t)(random_bits(seed) % IQFOC_PATTERN_ANGLES_MAX);
    for (int n = 0; n < ROWS; n++) {
        double angle[IQFOC_PATTERN_ANGLES_MAX];
        memset(&rows[n], 0, sizeof rows[n]);
        for (int k = 0; k < table.angles; k++) {
            angle[k] = uniform(seed, 0.0, 0.25);
        }
        qsort(angle, (size_t)table.angles, sizeof angle[0], rising);
        for (int k = 0; k < table.angles; k++) {
            rows[n].angle[k] = to_iq24(angle[k]);
        }
        rows[n].start = random_bits(seed) % 2 != 0 ? 1 : -1;
    }
    for (int n = 0; n + 1 < ROWS; n++) {
        rows[n].joined = rows[n].start == rows[n + 1].start;
    }
}

/* ---- The pattern by its definition; angles in turns ---- */

typedef struct pattern {
    int start, angles;
    double angle[IQFOC_PATTERN_ANGLES_MAX];
} pattern;

static inline double fraction(double x)
{
    return x - floor(x);
}

static inline int level_at(const pattern *p, double x)
{
    x = fraction(x);
    if (x >= 0.5) {
        return -level_at(p, x - 0.5);
    }
    const double y = x > 0.25 ? 0.5 - x : x;
    int level = p->start;
    for (int k = 0; k < p->angles; k++) {
        level = y > p->angle[k] ? -level : level;
    }
    return level;
}

/* The pattern at an index, with the line between rows that are joined. False: near where rows are exchanged. */
static inline bool pattern_at(double index, pattern *p)
{
    const double place = fmin(fmax((index - to_double(table.index_low)) * 100.0, 0.0), ROWS - 1);
    const int n = (int)place;
    const double part = place - n;
    p->angles = table.angles;
    p->start = rows[n].start;
    if (n + 1 < ROWS && !rows[n].joined && part > 0.2) {
        return false;
    }
    for (int k = 0; k < table.angles; k++) {
        const double a = to_double(rows[n].angle[k]);
        p->angle[k] = rows[n].joined ? a + part * (to_double(rows[n + 1].angle[k]) - a) : a;
    }
    return true;
}

/* Distances from x in the sense of turning to all edges of the turn, rising. */
static inline int distances(const pattern *p, double x, double sense, double distance[EDGES])
{
    int count = 0;
    for (int half = 0; half < 2; half++) {
        distance[count++] = 0.5 * half;
        for (int k = 0; k < p->angles; k++) {
            distance[count++] = 0.5 * half + p->angle[k];
            distance[count++] = 0.5 * half + 0.5 - p->angle[k];
        }
    }
    for (int k = 0; k < count; k++) {
        distance[k] = fraction(sense * (distance[k] - x));
    }
    qsort(distance, (size_t)count, sizeof distance[0], rising);
    return count;
}

/* ---- Edges of cycle after cycle ---- */

/* Of each leg the level and the time of the last edge, LSB of a cycle; of all the shortest time and the numbers. */
typedef struct edges_so_far {
    int32_t level[3];
    int64_t last[3];
    int64_t shortest;
    int32_t most; /* of a leg in a cycle */
    int64_t edges;
} edges_so_far;

static const edges_so_far no_edges_yet = {
    {-1, -1, -1}, {INT64_MIN / 2, INT64_MIN / 2, INT64_MIN / 2}, INT64_MAX, 0, 0};

/* Levels are continuous, and edges lie within their cycle, the one with this number. */
static inline void check_edges(const iqfoc_pattern_edges_t got[3], long cycle, edges_so_far *so_far)
{
    for (int leg = 0; leg < 3; leg++) {
        TEST_ASSERT_EQUAL_INT32(so_far->level[leg], got[leg].level);
        TEST_ASSERT_TRUE(got[leg].edges <= IQFOC_PATTERN_EDGES_MAX);
        TEST_ASSERT_TRUE(iq24_within(got[leg].high, 0, IQ24_ONE));
        for (int k = 0; k < got[leg].edges; k++) {
            TEST_ASSERT_TRUE(iq24_within(got[leg].instant[k], 0, IQ24_ONE - 1));
            const int64_t at = cycle * (int64_t)IQ24_ONE + got[leg].instant[k];
            const int64_t since = at - so_far->last[leg];
            so_far->shortest = since < so_far->shortest ? since : so_far->shortest;
            so_far->last[leg] = at;
            so_far->level[leg] = -so_far->level[leg];
        }
        so_far->most = iq24_max(so_far->most, got[leg].edges);
        so_far->edges += got[leg].edges;
    }
}

#endif

/*
 * The edges of a cycle in ticks of the carrier's timer, for iqfoc_hal_write_edges (hal.h).
 *
 * A cycle may be one of a pulse pattern (pattern.h) or a period of a carrier of any length (synchronous_carrier.h):
 *
 *     iqfoc_edges_of_pattern(pattern, period_ticks, &edges);        0 ... 16 edges of each leg
 *     iqfoc_edges_of_duties(high, period_ticks, &edges);            a pulse of each leg around the middle
 *     iqfoc_hal_write_edges(hal, &edges);
 *
 * No state; any context.
 */
#ifndef IQFOC_EDGES_H
#define IQFOC_EDGES_H

#include "pattern.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Longest cycle, ticks. */
#define IQFOC_EDGES_TICKS_MAX UINT32_C(16777215)

/*
 * A least time between two edges of a leg as the share of a cycle, rounded up, for iqfoc_pattern_init. A timer that needs `ticks` from edge
 * to edge then gets them after the conversion, too. Constants: ticks <= 8 period_ticks, period_ticks at most IQFOC_EDGES_TICKS_MAX.
 */
#define IQFOC_EDGES_LEAST(ticks, period_ticks)                                                               \
    ((iq24_t)((((int64_t)(ticks)*INT64_C(16777216)) + (int64_t)(period_ticks)-1) / (int64_t)(period_ticks)))

/* One leg in one cycle. Each edge changes the level. */
typedef struct iqfoc_leg_edges {
    int32_t level; /* at the cycle's start: 1 high, -1 low */
    int32_t edges; /* 0 ... IQFOC_PATTERN_EDGES_MAX */
    uint32_t instant
        [IQFOC_PATTERN_EDGES_MAX]; /* ticks from the cycle's start: each above the last, below period_ticks */
} iqfoc_leg_edges_t;

/* A cycle of the inverter. */
typedef struct iqfoc_edges {
    uint32_t period_ticks;    /* 2 ... IQFOC_EDGES_TICKS_MAX */
    iqfoc_leg_edges_t leg[3]; /* a, b, c */
} iqfoc_edges_t;

/*
 * The edges of a pattern, from shares of a cycle to ticks, rounded down: each edge is less than one tick early. Two edges on the same tick
 * are left out. Two edges that are n ticks apart or more stay n ticks apart or more, for whole n, also from one cycle to the next.
 *
 * pattern: legs a, b, c, from iqfoc_pattern_step or iqfoc_pattern_control_step. period_ticks: 2 ... IQFOC_EDGES_TICKS_MAX.
 */
void iqfoc_edges_of_pattern(const iqfoc_pattern_edges_t pattern[3], uint32_t period_ticks,
                            iqfoc_edges_t *edges);

/*
 * Centred pulses of a carrier. high: share of the cycle, held to 0 ... 1; its ticks are rounded to nearest, so the share is right to half a
 * tick. A leg with share 0 or 1 has no edge. The middle is that of the cycle, or half a tick before it. period_ticks: as above.
 */
void iqfoc_edges_of_duties(iqfoc_abc_t high, uint32_t period_ticks, iqfoc_edges_t *edges);

#ifdef __cplusplus
}
#endif

#endif

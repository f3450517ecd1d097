/* The place of a leg on the flux trajectory of its pulse pattern. */
#ifndef IQFOC_SRC_PATTERN_PLACE_H
#define IQFOC_SRC_PATTERN_PLACE_H

#include "iqfoc/pattern_control.h"

#include "pattern_leg.h"

/*
 * Numbers of edges are those of one family and one number of angles. The legs keep their levels: where the pattern has the other one, its
 * edge is still due, and the flux error may delay it.
 */
static inline void pattern_restart_legs(iqfoc_pattern_control_t *control, int32_t start)
{
    control->trajectory.start = start;
    for (int32_t k = 0; k < 3; k++) {
        control->leg[k].place = 0;
        control->leg[k].edge = -1;
        control->leg[k].level = control->modulator.leg[k].level;
    }
}

static inline iq24_acc_t pattern_square_q48(iq24_t x, iq24_t y)
{
    return iq24_acc_mac(iq24_acc_mul(x, x), y, y);
}

#define PATTERN_FAR_Q48  (INT64_C(1) << 62) /* more than any, and 1.5 times that fits */
#define PATTERN_NEAR_Q48 (INT64_C(1) << 22) /* a distance of 1/8192 is as good as none */

/* The square of a limit, and 1/2^bits of it more. */
static inline iq24_acc_t pattern_risen(iq24_acc_t limit_q48, uint32_t bits)
{
    return limit_q48 < PATTERN_FAR_Q48 / 2 ? limit_q48 + iq24_asr64(limit_q48, bits) : limit_q48;
}

/*
 * True at a distance within 1.2 of the least one. `seen`: a whole period of it has been seen. From then on, the limit rises by 1.5 % with
 * each call: if a turn has nearly a whole number of cycles, the least distance may not come again.
 */
static inline bool pattern_near(iq24_acc_t *nearest_q48, iq24_acc_t apart_q48, bool seen)
{
    iq24_acc_t nearest = *nearest_q48;
    if (seen) {
        nearest = nearest < PATTERN_NEAR_Q48 ? PATTERN_NEAR_Q48 : nearest;
        *nearest_q48 = pattern_risen(nearest, 5U);
        return apart_q48 <= iq24_asr64(nearest, 1) - iq24_asr64(nearest, 4) + nearest; /* 1.2^2 */
    }
    *nearest_q48 = apart_q48 < nearest ? apart_q48 : nearest;
    return false;
}

typedef struct {
    iq24_t y;      /* angle in the half turn: 0 ... 1/2, 1/2 excluded */
    int32_t level; /* the pattern's */
    iq24_t flux;   /* integral of the level: within +-1/4 */
} pattern_place_t;

/* n: number of the last edge at or before the place, in its half turn; in the cycle before, and now. */
static inline pattern_place_t pattern_place_of(const iqfoc_pattern_trajectory_t *t, iq24_t x, int32_t *n)
{
    const iq24_t y = x & (PATTERN_HALF_TURN - 1);
    /* These end at angle[0] = 0 and angle[edges] = 1/2. */
    const iq24_t *angle = &t->angle[*n];
    while (*angle > y) {
        angle--;
    }
    while (angle[1] <= y) {
        angle++;
    }
    const int32_t k = (int32_t)(angle - t->angle);
    *n = k;
    /* The second half turn and each edge change the sign. */
    const uint32_t changes = (uint32_t)k + ((uint32_t)x >> 23);
    const int32_t level = (changes & 1U) != 0 ? -t->start : t->start;
    const pattern_place_t place = {y, level, level * (y + t->ahead[k])};
    return place;
}

/* The angle of leg a at a rotor angle, but for whole turns: -1 ... 2. Those of the others are third_turn further each. */
static inline iq24_t pattern_angle_at(const iqfoc_pattern_trajectory_t *t, iq24_t theta)
{
    return t->sense * (theta & (IQ24_ONE - 1)) + t->u_place;
}

/* The edges of the cycle for a flux error at its start: control->error. Sets leg, the output's levels and control->high. */
void pattern_move_legs(iqfoc_pattern_control_t *control, const pattern_place_t place[3],
                       iqfoc_pattern_edges_t edges[3]);

/*
 * What a flux error control->error costs with these edges in the cycle: square of the error that is left at its end, plus 1/16 of that at
 * its start. The error at the start lasts half a cycle on average, and the one that is left some two cycles: (1/2 : 2)^2.
 */
iq24_acc_t pattern_cost_q48(const iqfoc_pattern_control_t *control, const iqfoc_pattern_edges_t edges[3]);

#endif

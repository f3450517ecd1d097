/* Parts that the modulators by pulse pattern share: a leg's output follows the pattern's level with a least time between edges. */
#ifndef IQFOC_SRC_PATTERN_LEG_H
#define IQFOC_SRC_PATTERN_LEG_H

#include "iqfoc/pattern.h"

#define PATTERN_HALF_TURN    INT32_C(8388608)
#define PATTERN_QUARTER_TURN INT32_C(4194304)
#define PATTERN_THIRD_TURN   INT32_C(5592405)

typedef struct {
    iqfoc_pattern_edges_t *out;
    iq24_t least;
    int32_t wanted; /* the pattern's level */
    iq24_t since;   /* the time of its last change: cycles */
    int32_t level;  /* the output's */
    iq24_t last;    /* the time of its last edge: negative in an earlier cycle */
} pattern_leg_t;

static inline pattern_leg_t pattern_leg_begin(const iqfoc_pattern_leg_t *state, iq24_t least, int32_t wanted,
                                              iqfoc_pattern_edges_t *out)
{
    const pattern_leg_t leg = {out, least, wanted, 0, state->level, -state->since};
    out->level = state->level;
    out->edges = 0;
    out->high = state->level > 0 ? IQ24_ONE : 0;
    return leg;
}

/* The output follows the pattern's level, if that is possible before the time `end`. */
static inline void pattern_leg_follow(pattern_leg_t *leg, iq24_t end)
{
    const iq24_t at = iq24_max(leg->since, leg->last + leg->least);
    if (leg->level != leg->wanted && at < end) {
        /*@ assert pattern_edges: 0 <= leg->out->edges < 16; */
        leg->out->at[leg->out->edges] = at;
        leg->out->edges++;
        leg->out->high += leg->wanted > 0 ? IQ24_ONE - at : at - IQ24_ONE;
        /*@ assert pattern_high: 0 <= leg->out->high <= 16777216; */
        leg->level = leg->wanted;
        leg->last = at;
    }
}

static inline void pattern_leg_end(pattern_leg_t *leg, iqfoc_pattern_leg_t *state)
{
    pattern_leg_follow(leg, IQ24_ONE);
    state->level = leg->level;
    state->since = iq24_min(IQ24_ONE - leg->last, IQFOC_PATTERN_TIME_MAX);
}

#endif

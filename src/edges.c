/* Edges of a cycle in ticks (include/iqfoc/edges.h). */
#include "iqfoc/edges.h"

#include "iqfoc/iq24_math.h"

/* floor(share period_ticks). Range: share is at most 1, so that the product is below 2^48. */
static uint32_t ticks_of(iq24_t share, uint32_t period_ticks)
{
    return (uint32_t)(((uint64_t)(uint32_t)share * period_ticks) >> IQ24_FRACTION_BITS);
}

static void leg_of_pattern(const iqfoc_pattern_edges_t *pattern, uint32_t period_ticks,
                           iqfoc_leg_edges_t *leg)
{
    uint32_t last = period_ticks; /* no edge has this tick */
    int32_t edges = 0;
    for (int32_t k = 0; k < pattern->edges; k++) {
        const uint32_t instant = ticks_of(pattern->instant[k], period_ticks);
        /*@ assert edges_kept: 0 <= edges <= k; */
        if (instant == last) {
            edges--;
            last = period_ticks;
        } else {
            leg->instant[edges] = instant;
            edges++;
            last = instant;
        }
    }
    leg->level = pattern->level;
    leg->edges = edges;
}

void iqfoc_edges_of_pattern(const iqfoc_pattern_edges_t pattern[3], uint32_t period_ticks,
                            iqfoc_edges_t *edges)
{
    edges->period_ticks = period_ticks;
    for (int32_t k = 0; k < 3; k++) {
        leg_of_pattern(&pattern[k], period_ticks, &edges->leg[k]);
    }
}

static void leg_of_duty(iq24_t duty, uint32_t period_ticks, iqfoc_leg_edges_t *leg)
{
    const iq24_t share = iq24_clamp(duty, 0, IQ24_ONE);
    const uint64_t product = (uint64_t)(uint32_t)share * period_ticks + (UINT32_C(1) << 23);
    const uint32_t high = (uint32_t)(product >> IQ24_FRACTION_BITS);
    leg->level = high == period_ticks ? 1 : -1;
    leg->edges = high == 0 || high == period_ticks ? 0 : 2;
    leg->instant[0] = (period_ticks - high) / 2;
    leg->instant[1] = leg->instant[0] + high;
}

void iqfoc_edges_of_duties(iqfoc_abc_t high, uint32_t period_ticks, iqfoc_edges_t *edges)
{
    edges->period_ticks = period_ticks;
    leg_of_duty(high.a, period_ticks, &edges->leg[0]);
    leg_of_duty(high.b, period_ticks, &edges->leg[1]);
    leg_of_duty(high.c, period_ticks, &edges->leg[2]);
}

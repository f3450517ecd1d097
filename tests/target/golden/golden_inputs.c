/*
 * Inputs of the golden vectors (golden_inputs.h).
 */
#include "golden_inputs.h"

/* 0, the ends, and +-2^k with its neighbours: 4 + 31 * 6, and 2 to make it even. */
#define EXTREMES 192

static iq24_t extreme(uint32_t k)
{
    static const iq24_t ends[6] = {0, IQ24_MIN, IQ24_MIN + 1, IQ24_MAX, IQ24_MAX - 1, 3};
    if (k < 6) {
        return ends[k];
    }
    const iq24_t power = (iq24_t)(UINT32_C(1) << ((k - 6) / 6));
    const iq24_t near = power + (iq24_t)((k - 6) % 3) - 1;
    return (k - 6) % 6 < 3 ? near : -near;
}

/* splitmix64. */
static uint64_t draw(golden_inputs_t *inputs)
{
    inputs->state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = inputs->state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static iq24_t any_magnitude(golden_inputs_t *inputs)
{
    const uint64_t bits = draw(inputs);
    return iq24_asr32(iq24_wrap((int64_t)(bits & UINT32_MAX)), (uint32_t)(bits >> 59));
}

void golden_pair(golden_inputs_t *inputs, iq24_t *a, iq24_t *b)
{
    const uint32_t number = inputs->number++;
    if (number < EXTREMES * EXTREMES) {
        *a = extreme(number / EXTREMES);
        *b = extreme(number % EXTREMES);
    } else {
        *a = any_magnitude(inputs);
        *b = any_magnitude(inputs);
    }
}

iq24_t golden_within(golden_inputs_t *inputs, iq24_t limit)
{
    const uint64_t bits = draw(inputs);
    switch (bits >> 60) {
    case 0:
        return limit;
    case 1:
        return -limit;
    case 2:
        return 0;
    default:
        return (iq24_t)((int64_t)((bits & UINT32_MAX) * (2 * (uint64_t)limit + 1) >> 32) - limit);
    }
}

/*
 * What the control cycle asks of each sample and of the time, all at once.
 *
 * Each question is a number whose top bit says no; they are joined, and one test of that bit is all that a
 * healthy cycle spends. Which of them it was is found out where it fires (src/cycle.c). A limit of time above
 * 2^31 ticks only makes it fire more often.
 */
#ifndef IQFOC_CYCLE_GUARD_H
#define IQFOC_CYCLE_GUARD_H

#include "cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_CYCLE_U_DC_MIN IQ24(0.5)
#define IQFOC_CYCLE_U_DC_MAX IQ24(1.5)

/* Ticks from one time to a later one. They wrap: the difference modulo 2^32 is right across the wrap. */
static inline uint32_t iqfoc_ticks_since(uint32_t then, uint32_t now)
{
    return (uint32_t)((UINT64_C(0x100000000) + now - then) & UINT32_MAX);
}

/*
 * Top bit set where |x| > limit >= 0; -limit - 1 is still let through.
 *
 * Range: x ^ (x >> 31) is x or -x - 1, 0 ... 2^31 - 1, so the difference of two such numbers cannot overflow.
 */
static inline uint32_t iqfoc_guard_beyond(iq24_t x, iq24_t limit)
{
    return (uint32_t)(limit - (x ^ iq24_asr32(x, 31)));
}

/* Top bit set where `age` is more than `limit`, or so much that the time must have run backwards. */
static inline uint32_t iqfoc_guard_older(uint32_t age, uint32_t limit)
{
    return age | iqfoc_ticks_since(age, limit);
}

/* The values of a sample, of its currents' vector and of its age. */
static inline uint32_t iqfoc_guard_sample(const iqfoc_cycle_config_t *set, const iqfoc_sample_t *sample,
                                          iqfoc_ab_t i, uint32_t now)
{
    return iqfoc_guard_beyond(i.alpha, set->current_limit) | iqfoc_guard_beyond(i.beta, set->current_limit) |
           iqfoc_guard_beyond(sample->turns, IQFOC_ROTOR_TURNS_MAX) |
           iqfoc_guard_beyond(iq24_sub_wrap(sample->u_dc, IQ24_ONE), IQ24(0.5)) |
           iqfoc_guard_older(iqfoc_ticks_since(sample->time, now), set->stale_ticks) |
           (uint32_t)sample->clipped << 31;
}

/* True where no look at the deadline is needed: the quick half of iqfoc_cycle_in_time. time: of the sample. */
static inline bool iqfoc_cycle_in_time_inline(const iqfoc_cycle_t *cycle, uint32_t time, uint32_t now)
{
    return iqfoc_guard_older(iqfoc_ticks_since(time, now), cycle->config->deadline_ticks) <= INT32_MAX;
}

/* Something was wrong with a valley's sample, or it is the first: sets what it was. i_next becomes i where the
 * cycle before it was not whole, so that it shows no error. Returns whether it was whole. */
bool iqfoc_cycle_odd_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/* The same for a sample of which no order is asked. */
void iqfoc_cycle_odd_sample(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/* The same for a peak's. */
void iqfoc_cycle_odd_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/* Sets sticky bits, and trips where the configuration says so. */
void iqfoc_cycle_set_status(iqfoc_cycle_t *cycle, uint32_t bits);

/* No voltage, and nothing integrated. Returns the safe command. */
iqfoc_command_t iqfoc_cycle_stopped(iqfoc_cycle_t *cycle);

/* The middle of the output where the next cycle's length differs from this one's. */
iq24_t iqfoc_cycle_stretched(const iqfoc_cycle_t *cycle, iq24_t output_mid);

#ifdef __cplusplus
}
#endif

#endif

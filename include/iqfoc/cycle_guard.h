/*
 * The checks of each sample and of its time in the control cycle.
 *
 * Each check is one comparison and a branch that a healthy cycle does not take (IQ24_RARE): fewer instructions on
 * every core than numbers joined by OR. If a check fails, src/cycle.c finds which one.
 */
#ifndef IQFOC_CYCLE_GUARD_H
#define IQFOC_CYCLE_GUARD_H

#include "cycle.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_CYCLE_U_DC_MIN IQ24(0.5)
#define IQFOC_CYCLE_U_DC_MAX IQ24(1.5)

/*
 * The guard's limit of the speed, 0.4 % below IQFOC_ROTOR_SPEED_MAX: a constant of one instruction on each core. Between the
 * two it finds nothing, as src/cycle.c asks for the limit itself.
 */
#define IQFOC_GUARD_SPEED INT32_C(0x00550000)

/* Ticks from one time to a later one, modulo 2^32: correct across the timer's wrap. */
static inline uint32_t iqfoc_ticks_since(uint32_t then, uint32_t now)
{
    return (uint32_t)((UINT64_C(0x100000000) + now - then) & UINT32_MAX);
}

/* What a guard returns if a check failed; else 0. A bool in its place takes one instruction more on a Cortex-M4. */
#define IQFOC_GUARD_WRONG UINT32_C(0x80000000)

/* Wrong if |x| > limit >= 0; -limit - 1 still passes. x ^ (x >> 31) is x or -x - 1: one comparison for both ends. */
static inline uint32_t iqfoc_guard_beyond(iq24_t x, iq24_t limit)
{
    return IQ24_RARE((x ^ iq24_asr32(x, 31)) > limit) ? IQFOC_GUARD_WRONG : 0;
}

/* Wrong if u_dc is outside 0.5 ... 1.5. */
static inline uint32_t iqfoc_guard_dc_link(iq24_t u_dc)
{
    return IQ24_RARE((uint32_t)(((int64_t)u_dc - IQFOC_CYCLE_U_DC_MIN) & UINT32_MAX) >
                     (uint32_t)(IQFOC_CYCLE_U_DC_MAX - IQFOC_CYCLE_U_DC_MIN))
               ? IQFOC_GUARD_WRONG
               : 0;
}

/* The checks of age, DC link and speed. A time that ran backwards is a large age. */
static inline uint32_t iqfoc_guard_scalars(const iqfoc_cycle_config_t *set, const iqfoc_sample_t *sample,
                                           uint32_t now)
{
    const bool wrong = IQ24_RARE(iqfoc_ticks_since(sample->time, now) > set->stale_ticks) ||
                       iqfoc_guard_dc_link(sample->u_dc) != 0 ||
                       iqfoc_guard_beyond(sample->speed, IQFOC_GUARD_SPEED) != 0;
    return wrong ? IQFOC_GUARD_WRONG : 0;
}

/* The check of a current vector. */
static inline uint32_t iqfoc_guard_current(const iqfoc_cycle_config_t *set, iqfoc_ab_t i)
{
    const bool wrong = iqfoc_guard_beyond(i.alpha, set->current_limit) != 0 ||
                       iqfoc_guard_beyond(i.beta, set->current_limit) != 0;
    return wrong ? IQFOC_GUARD_WRONG : 0;
}

/*
 * The same for a peak's phase currents, whose Clarke transform most methods do not need. Wrong if |alpha| > limit or
 * |beta| > 0.974 limit, as 3/2 + 3/16 is a little below sqrt(3). Where only this one is beyond, src/cycle.c finds nothing.
 *
 *     3 alpha = 2 a - b - c,   sqrt(3) beta = b - c
 *
 * Range: 3 limit <= 48.
 */
static inline uint32_t iqfoc_guard_phases(const iqfoc_cycle_config_t *set, iqfoc_abc_t i)
{
    const iq24_t limit = 3 * set->current_limit;
    const iq24_t along = iq24_sub_wrap(iq24_add_wrap(i.a, i.a), iq24_add_wrap(i.b, i.c));
    const bool wrong =
        iqfoc_guard_beyond(along, limit) != 0 ||
        iqfoc_guard_beyond(iq24_sub_wrap(i.b, i.c), iq24_asr32(limit, 1) + iq24_asr32(limit, 4)) != 0;
    return wrong ? IQFOC_GUARD_WRONG : 0;
}

/* All checks of a sample: its values, its current vector and its age. */
static inline uint32_t iqfoc_guard_sample(const iqfoc_cycle_config_t *set, const iqfoc_sample_t *sample,
                                          iqfoc_ab_t i, uint32_t now)
{
    return sample->clipped || iqfoc_guard_scalars(set, sample, now) != 0 || iqfoc_guard_current(set, i) != 0
               ? IQFOC_GUARD_WRONG
               : 0;
}

/* True if the deadline is kept: the fast path of iqfoc_cycle_in_time. time: the sample's. From the peak's interrupt. */
static inline bool iqfoc_cycle_in_time_inline(const iqfoc_cycle_t *cycle, uint32_t time, uint32_t now)
{
    return iqfoc_ticks_since(time, now) <= cycle->config->deadline_ticks;
}

/*
 * Finds what is wrong with a valley's sample and sets its status bits; also called at the first valley. If the cycle
 * before it was not complete, i_next becomes i, so that the prediction error is zero. Returns whether that cycle was
 * complete. From the valley's interrupt only.
 */
bool iqfoc_cycle_report_valley(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * The same for a sample of six-step by a timer, without a check of the order of valleys and peaks. From the cycle's
 * interrupts only.
 */
void iqfoc_cycle_report_sample(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/*
 * The same for a peak's sample. Returns false ahead of the first valley, when the output stays safe. From the peak's
 * interrupt only.
 */
bool iqfoc_cycle_report_peak(iqfoc_cycle_t *cycle, const iqfoc_sample_t *sample, uint32_t now);

/* Sets sticky status bits, and trips on those of config->trips. From the cycle's interrupts only. */
void iqfoc_cycle_set_status(iqfoc_cycle_t *cycle, uint32_t bits);

/* Sets voltage and integrators to zero. Returns the safe command. From the cycle's interrupts only. */
iqfoc_command_t iqfoc_cycle_stopped(iqfoc_cycle_t *cycle);

/* output_mid for a next cycle whose length differs from that of the present one. From the peak's interrupt only. */
iq24_t iqfoc_cycle_output_mid_scaled(const iqfoc_cycle_t *cycle, iq24_t output_mid);

/* Deprecated names of version 0.1. The next version has only the names above. */
#define iqfoc_cycle_odd_valley iqfoc_cycle_report_valley
#define iqfoc_cycle_odd_sample iqfoc_cycle_report_sample
#define iqfoc_cycle_odd_peak   iqfoc_cycle_report_peak
#define iqfoc_cycle_stretched  iqfoc_cycle_output_mid_scaled

#ifdef __cplusplus
}
#endif

#endif

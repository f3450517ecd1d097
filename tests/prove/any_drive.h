/* Values of the larger structs: a set of parameters, a sample, an extension, a salient machine. */
#ifndef TESTS_PROVE_ANY_DRIVE_H
#define TESTS_PROVE_ANY_DRIVE_H

#include "any.h"

#include "iqfoc/cycle.h"

/* Within predictor_salient.h. */
static inline iqfoc_salient_machine_t any_salient(int32_t k_least_q26)
{
    const iqfoc_salient_machine_t machine = {
        any_within(0, 1 << 30),           any_within(0, 1 << 30),       any_within(k_least_q26, 1 << 30),
        any_within(k_least_q26, 1 << 30), any_within(0, 1 << 30),       any_within(0, 1 << 30),
        any_within(1 << 24, 1 << 30),     any_within(1 << 24, 1 << 30),
    };
    return machine;
}

/* Coefficients within Q26's 32; the sums that a step forms of them are within its range: predictor_salient.h. */
static inline iqfoc_salient_row_t any_salient_row(void)
{
    const iqfoc_salient_row_t row = {any_within(-(1 << 29), 1 << 29), any_within(-(1 << 29), 1 << 29),
                                     any_within(-(1 << 30), 1 << 30), any_within(-(1 << 30), 1 << 30),
                                     any_within(-1127428916, 1127428916)};
    return row;
}

static inline iqfoc_salient_t any_salient_law(void)
{
    const iqfoc_salient_t law = {any_salient_row(), any_salient_row()};
    return law;
}

/* Whatever memory may hold: what the checks are for. */
static inline iqfoc_extension_t any_extension(void)
{
    const iqfoc_extension_t x = {
        any_abc(IQ24_MIN, IQ24_MAX), any_abc(IQ24_MIN, IQ24_MAX), any(), any(), any(), any(), any(), any()};
    return x;
}

/* The same of a set of parameters, without what only named methods need. */
static inline iqfoc_cycle_config_t any_set(void)
{
    const iqfoc_cycle_config_t set = {
        .predictor = {any(), any(), any()},
        .gains = {any(), any(), any(), any(), any(), any(), any(), any()},
        .feedback = (iqfoc_feedback_t)any_within(0, 4),
        .modulation = (iqfoc_modulation_t)any_within(0, 2),
        .safe_state = (iqfoc_safe_state_t)any_within(0, 1),
        .span_max = any(),
        .current_limit = any(),
        .period_ticks = any_count(0, UINT32_MAX),
        .tolerance_ticks = any_count(0, UINT32_MAX),
        .stale_ticks = any_count(0, UINT32_MAX),
        .deadline_ticks = any_count(0, UINT32_MAX),
        .trips = any_count(0, UINT32_MAX),
    };
    return set;
}

/* Any numbers whatever; only the instant is what the port says it is. */
static inline iqfoc_sample_t any_sample(void)
{
    const iqfoc_sample_t sample = {
        any_abc(IQ24_MIN, IQ24_MAX),     any_abc(IQ24_MIN, IQ24_MAX), any(),      any(),     any(),
        any_within(-IQ24_ONE, IQ24_ONE), any_count(0, UINT32_MAX),    any_bool(), any_bool()};
    return sample;
}

#endif

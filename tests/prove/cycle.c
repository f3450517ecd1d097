/* The control cycle as a whole, and its use by the ports. */
#include "any_drive.h"

#include "iqfoc/cycle_steps.h"
#include "iqfoc/sensorless.h"

#include "corrected_drive.h"
#include "first_drive.h"

/* A drive at any time: a set that was not refused, and any state that the steps can leave. */
static void run(const iqfoc_methods_t methods, const iqfoc_cycle_config_t *set,
                const iqfoc_cycle_config_t *other)
{
    iqfoc_cycle_t cycle;
    if (iqfoc_cycle_init_by(methods, &cycle, other) != IQFOC_OK ||
        iqfoc_cycle_init_by(methods, &cycle, set) != IQFOC_OK) {
        return;
    }
    while (any_bool()) {
        const iqfoc_sample_t valley = any_sample();
        const iqfoc_sample_t peak = any_sample();
        cycle.enabled = any_bool();
        cycle.i_ref = any_dq(IQ24(32.0));
        if (any_bool()) {
            iqfoc_cycle_valley_by(methods, &cycle, &valley, any_count(0, UINT32_MAX));
        }
        if (any_bool()) {
            (void)iqfoc_cycle_offer_by(methods, &cycle, other);
        }
        if (any_bool()) {
            (void)iqfoc_cycle_peak_by(methods, &cycle, &peak, any_within(0, IQ24(8.0)),
                                      any_count(0, UINT32_MAX));
            (void)iqfoc_cycle_in_time(&cycle, &peak, any_count(0, UINT32_MAX));
            (void)iqfoc_cycle_in_time_inline(&cycle, any_count(0, UINT32_MAX), any_count(0, UINT32_MAX));
            (void)iqfoc_cycle_next_ticks(&cycle);
            (void)iqfoc_cycle_taken(&cycle);
        }
        if (any_bool()) {
            iqfoc_cycle_clear(&cycle);
        }
    }
}

/* Lengths of a cycle that iqfoc_cycle_init would refuse are left out ahead of it: the analysis forgets which they were. */
static iqfoc_cycle_config_t any_timed_set(void)
{
    iqfoc_cycle_config_t set = any_set();
    set.period_ticks = any_count(1, INT32_MAX);
    return set;
}

static void run_any(const iqfoc_methods_t methods)
{
    const iqfoc_cycle_config_t set = any_timed_set();
    const iqfoc_cycle_config_t other = any_timed_set();
    run(methods, &set, &other);
}

/* The drive of examples/first_drive: any set that is not refused, any samples in any order, another set offered. */
void prove_cycle_first_drive(void)
{
    run_any(first_drive_methods);
}

/* The drive of examples/corrected_drive: the same, with any extension that is not refused. */
void prove_cycle_corrected_drive(void)
{
    const iqfoc_extension_t x = any_extension();
    iqfoc_cycle_config_t set = any_timed_set();
    iqfoc_cycle_config_t other = any_timed_set();
    set.data.extension = &x;
    other.data.extension = &x;
    run(corrected_drive_methods, &set, &other);
}

/* The ready-made cycle, feedback and modulation as the set says: the same. */
void prove_cycle_ready_made(void)
{
    const iqfoc_cycle_config_t set = any_timed_set();
    const iqfoc_cycle_config_t other = any_timed_set();
    iqfoc_cycle_t cycle;
    if (iqfoc_cycle_init(&cycle, &other) != IQFOC_OK || iqfoc_cycle_init(&cycle, &set) != IQFOC_OK) {
        return;
    }
    while (any_bool()) {
        const iqfoc_sample_t valley = any_sample();
        const iqfoc_sample_t peak = any_sample();
        cycle.enabled = any_bool();
        cycle.i_ref = any_dq(IQ24(32.0));
        if (any_bool()) {
            iqfoc_cycle_valley(&cycle, &valley, any_count(0, UINT32_MAX));
        }
        if (any_bool()) {
            (void)iqfoc_cycle_offer(&cycle, &other);
        }
        if (any_bool()) {
            (void)iqfoc_cycle_peak(&cycle, &peak, any_within(0, IQ24(8.0)), any_count(0, UINT32_MAX));
        }
    }
}

/* Another angle while it runs: any set that is not refused, any angles and speed, |phases| <= 15.9, |u_dq| <= 8. */
void prove_cycle_hand_over(void)
{
    const iqfoc_cycle_config_t set = any_timed_set();
    iqfoc_cycle_t cycle;
    if (iqfoc_cycle_init(&cycle, &set) == IQFOC_OK) {
        iqfoc_sample_t sample = any_sample();
        sample.i = any_abc(-IQ24(15.9), IQ24(15.9));
        cycle.u_dq = any_dq(IQ24(8.0));
        iqfoc_cycle_hand_over(&cycle, any(), &sample);
    }
}

/* A drive without an angle sensor: any source, stage and sample, |u_now| <= 2; the observer is one of its own proof. */
void prove_sensorless(void)
{
    static const iqfoc_observer_config_t observer =
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 5e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.005));
    const iqfoc_start_config_t start = {
        any_within(1, IQ24(16.0)), any_count(1, 1U << 24), any_count(1, 1U << 24),
        any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX), any_count(1, 1U << 24)};
    const iqfoc_extension_t x = any_extension();
    const iqfoc_cycle_config_t set = any_timed_set();
    iqfoc_cycle_t cycle;
    iqfoc_sensorless_t s;
    if (iqfoc_cycle_init(&cycle, &set) != IQFOC_OK || iqfoc_extension_check(&x) != IQFOC_OK ||
        iqfoc_sensorless_init(&s, &observer, &start, any_bool() ? &x : NULL) != IQFOC_OK) {
        return;
    }
    if (any_bool()) {
        iqfoc_sensorless_start(&s);
    } else if (any_bool()) {
        iqfoc_sensorless_catch(&s, any());
    } else {
        iqfoc_sensorless_use(&s, any_bool());
    }
    while (any_bool()) {
        iqfoc_sample_t valley = any_sample();
        iqfoc_sample_t peak = any_sample();
        cycle.enabled = any_bool();
        cycle.tripped = any_bool();
        cycle.u_now = any_ab(IQ24(2.0));
        cycle.u_dq = any_dq(IQ24(8.0));
        cycle.i_valley = any_ab(IQ24_MAX);
        s.start.done = any_count(0, 1U << 24);
        iqfoc_sensorless_valley(&s, &cycle, &valley);
        iqfoc_sensorless_peak(&s, &peak);
    }
}

/* Controllers and modulators beyond the papers', and their current reference. */
#include "any_drive.h"

#include "iqfoc/cycle_six_step.h"
#include "iqfoc/edges.h"
#include "iqfoc/overmodulation.h"
#include "iqfoc/pattern.h"
#include "iqfoc/reference.h"
#include "iqfoc/tuned_control.h"

/* Reference by torque: any configuration that is not refused, any torque, any voltage, from any state. */
void prove_reference(void)
{
    const iqfoc_reference_config_t config = {any(), any(), any(), any(), any()};
    if (iqfoc_reference_check(&config) == IQFOC_OK) {
        iqfoc_reference_t reference = {(int64_t)any_within(-IQ24(12.0), 0) * IQ24_ONE,
                                       any_within(-IQ24(4.0), IQ24(4.0))};
        (void)iqfoc_reference_step(&reference, &config, any_within(-IQ24(8.0), IQ24(8.0)), any_dq(IQ24_MAX),
                                   any_within(0, IQ24(1.5)));
        iqfoc_reference_link_t link = {any(), any_within(0, IQ24(1.5))};
        (void)iqfoc_reference_link(&reference, &link, &config, any_dq(IQ24_MAX), any_within(0, IQ24(1.5)));
    }
}

/* Overmodulation: |u| <= 32, 0 < 1/u_dc <= 2, any speed, from any state; the nearest point and the duties' voltage. */
void prove_overmodulation(void)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(any());
    iqfoc_overmodulation_t state = {any_within(0, IQ24(8.0))};
    const iq24_t limit = any_within(IQFOC_OVERMODULATION_CIRCLE, iqfoc_overmodulation_limit(&rotor));
    (void)iqfoc_overmodulate(&state, any_ab(IQ24(32.0)), any_within(1, IQ24(2.0)), limit);
    (void)iqfoc_modulate_nearest(any_ab(IQ24(32.0)), any_within(1, IQ24(2.0)));
    (void)iqfoc_modulated_voltage(any_abc(0, IQ24_ONE), any_within(0, IQ24(2.0)));
}

/* A number of angles at a time, as it says which edges there are. */
static void pattern_of(const iqfoc_pattern_row_t *row, int32_t angles)
{
    const iqfoc_pattern_t table = {row, any_within(1, IQFOC_PATTERN_ROWS_MAX), angles,
                                   any_within(0, IQ24_ONE), any_within(IQ24_ONE, IQ24(100.0))};
    iqfoc_pattern_modulator_t modulator = {
        &table, any_within(0, IQFOC_PATTERN_TIME_MAX), any_within(0, IQFOC_PATTERN_ROWS_MAX - 1), {{0}}};
    for (int32_t k = 0; k < 3; k++) {
        modulator.leg[k].level = any_bool() ? 1 : -1;
        modulator.leg[k].since = any_within(0, IQFOC_PATTERN_TIME_MAX);
    }
    const iq24_t index = iqfoc_pattern_index(any_within(0, IQ24(32.0)), any_within(1, IQ24(2.0)));
    iqfoc_pattern_edges_t edges[3];
    iqfoc_pattern_step(&modulator, any(), any(), any_bool() ? index : any(), edges);
}

/* Edges in ticks: any edges within pattern.h, any duties, periods of 2, 17000 and 2^24 - 1 ticks. */
void prove_edges(void)
{
    static const uint32_t period[3] = {2, 17000, IQFOC_EDGES_TICKS_MAX};
    iqfoc_pattern_edges_t asked[3];
    iqfoc_edges_t edges;
    for (int32_t x = 0; x < 3; x++) {
        asked[x].level = any_bool() ? 1 : -1;
        asked[x].edges = any_within(0, IQFOC_PATTERN_EDGES_MAX);
        for (int32_t k = 0; k < IQFOC_PATTERN_EDGES_MAX; k++) {
            asked[x].instant[k] = any_within(0, IQ24_ONE - 1);
        }
    }
    for (int32_t n = 0; n < 3; n++) {
        iqfoc_edges_of_pattern(asked, period[n], &edges);
        iqfoc_edges_of_duties(any_abc(IQ24_MIN, IQ24_MAX), period[n], &edges);
    }
}

/* Modulation by pulse pattern: any table within pattern.h, any angle, speed and index, from any state of the legs; the
 * check of any table. */
void prove_pattern(void)
{
    static iqfoc_pattern_row_t row[IQFOC_PATTERN_ROWS_MAX];
    const iqfoc_pattern_t whatever = {row, any(), any(), any(), any()};
    iqfoc_pattern_modulator_t checked;
    for (int32_t n = 0; n < IQFOC_PATTERN_ROWS_MAX; n++) {
        row[n].start = any();
        row[n].joined = any();
        for (int32_t k = 0; k < IQFOC_PATTERN_ANGLES_MAX; k++) {
            row[n].angle[k] = any();
        }
    }
    (void)iqfoc_pattern_init(&checked, &whatever, any());
    for (int32_t n = 0; n < IQFOC_PATTERN_ROWS_MAX; n++) {
        row[n].start = any_bool() ? 1 : -1;
        row[n].joined = any_within(0, 1);
        for (int32_t k = 0; k < IQFOC_PATTERN_ANGLES_MAX; k++) {
            row[n].angle[k] = any_within(0, IQ24(0.25));
        }
    }
    for (int32_t angles = 0; angles <= IQFOC_PATTERN_ANGLES_MAX; angles++) {
        pattern_of(row, angles);
    }
}

/* The law of the tuned controller at any speed: any machine within predictor_salient.h whose k is 1/16 and more. */
void prove_tuned_law(void)
{
    const iqfoc_tuned_law_t law = {any_salient(IQFOC_TUNED_K_LEAST_Q26), any_within(0, IQ24_ONE),
                                   any_within(0, IQ24_ONE), any_within(0, IQ24_ONE), any_within(0, IQ24_ONE)};
    (void)iqfoc_tuned_at_speed(&law, any());
}

/* The tuned controller's cycle, from any state: any coefficients, |G^-1| <= 32, any sample, |i_ref| <= 8, |u| <= 1. */
void prove_tuned_step(void)
{
    iqfoc_tuned_t tuned;
    tuned.end = any_salient_law();
    tuned.voltage_dd = any_within(-IQ24(32.0), IQ24(32.0));
    tuned.voltage_dq = any_within(-IQ24(32.0), IQ24(32.0));
    tuned.voltage_qd = any_within(-IQ24(32.0), IQ24(32.0));
    tuned.voltage_qq = any_within(-IQ24(32.0), IQ24(32.0));
    tuned.keep_cos = any_within(-IQ24_ONE, IQ24_ONE);
    tuned.keep_sin = any_within(-IQ24_ONE, IQ24_ONE);
    tuned.reference.gain = any_within(IQ24_ONE, IQ24(1.4626));
    tuned.reference.magnet_pu = any_within(0, IQ24(3.8));
    tuned.bow = any_within(IQ24(0.62), IQ24(0.67));
    tuned.speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    tuned.follow = any_within(0, IQ24_ONE);
    tuned.learn = any_within(0, IQ24_ONE);
    tuned.learn_offset = any_within(0, IQ24_ONE);
    iqfoc_tuned_state_t state;
    state.drift = any_dq(IQ24(4.0));
    state.offset = any_dq(IQ24_ONE);
    state.aim = any_dq(IQ24(8.0));
    iqfoc_tuned_ripple(&state, any_dq(IQ24_MAX));
    state.i = any_dq(IQ24(8.0));
    state.i_mid = any_dq(IQ24_MAX);
    state.i_next = any_dq(IQ24(8.0));
    state.error = any_dq(IQ24_MAX);
    state.predicted = any_bool();
    state.has_mid = any_bool();
    iqfoc_tuned_peak(&state, any_ab(IQ24(64.0)), any());
    (void)iqfoc_tuned_step(&state, &tuned, any_ab(IQ24(64.0)), any_ab(IQ24_ONE), any_dq(IQ24(8.0)), any());
}

/* Six-step by a timer: any configuration, fit or not, any samples, any drive that iqfoc_cycle_init has not refused. */
void prove_six_step_timer(void)
{
    const iqfoc_cycle_config_t set = any_set();
    const iqfoc_six_step_config_t config = {any(), any(), any(), any_bool()};
    iqfoc_cycle_t cycle;
    iqfoc_six_step_t six;
    if (iqfoc_cycle_init(&cycle, &set) == IQFOC_OK) {
        iqfoc_sample_t sample = any_sample();
        cycle.enabled = any_bool();
        cycle.u_dq = any_dq(IQ24_MAX);
        (void)iqfoc_cycle_six_step_begin(&six, &cycle, any_bool() ? &config : 0,
                                         iqfoc_cycle_voltage_angle(&cycle), &sample);
        while (six.config != 0 && any_bool()) {
            sample = any_sample();
            cycle.enabled = any_bool();
            cycle.i_ref = any_dq(IQ24(32.0));
            (void)iqfoc_cycle_six_step_switch(&six, &cycle, &sample, any_count(0, UINT32_MAX));
        }
        if (six.config != 0) {
            iqfoc_cycle_six_step_end(&six, &cycle, any());
        }
    }
}

/*
 * Counts the optional modules and the drive services (bench/services.h): overmodulation, reference, tuned control, watch, angle
 * sensors, start, shunts, supervision. Each is called once a cycle and keeps its state from call to call.
 */
#include "services.h"

#include "iqfoc/adapt.h"
#include "iqfoc/commission.h"
#include "iqfoc/cycle_six_step.h"
#include "iqfoc/edges.h"
#include "iqfoc/encoder.h"
#include "iqfoc/halls.h"
#include "iqfoc/observer_inductance.h"
#include "iqfoc/observer_resistance.h"
#include "iqfoc/offset.h"
#include "iqfoc/overmodulation.h"
#include "iqfoc/pattern.h"
#include "iqfoc/pattern_control.h"
#include "iqfoc/pulse_mode.h"
#include "iqfoc/recorder.h"
#include "iqfoc/reference.h"
#include "iqfoc/resolver.h"
#include "iqfoc/restart.h"
#include "iqfoc/sensorless.h"
#include "iqfoc/shunts.h"
#include "iqfoc/speed_control.h"
#include "iqfoc/start.h"
#include "iqfoc/supervision.h"
#include "iqfoc/synchronous_carrier.h"
#include "iqfoc/tracker.h"
#include "iqfoc/tuned_control.h"
#include "iqfoc/watch.h"
#include "iqfoc/watch_angle.h"

#include "count.h"

static iqfoc_overmodulation_t over;
static iq24_t over_limit;
static const iqfoc_reference_config_t reference_config = {IQ24(0.1), IQ24(1.5), IQ24(-1.0), IQ24(0.01),
                                                          IQ24(0.98)};
static iqfoc_reference_t reference;
static const iqfoc_six_step_config_t six_step_config = {IQ24(0.001), 0, IQ24(0.5), false};
static iqfoc_six_step_t six_step;
/* Nine pulses per electrical period, between two rows of the table. */
static const iqfoc_pattern_row_t pattern_rows[2] = {
    {1, 1, {IQ24(0.03), IQ24(0.05), IQ24(0.12), IQ24(0.13)}},
    {1, 0, {IQ24(0.05), IQ24(0.06), IQ24(0.15), IQ24(0.155)}}};
static const iqfoc_pattern_t pattern_table = {pattern_rows, 2, 4, IQ24(0.5), IQ24(2.0)};
static iqfoc_pattern_modulator_t pattern;
static iqfoc_pattern_edges_t pattern_edges[3];
static iqfoc_edges_t edges;
/* Nine pulses, the angles of least distortion at index 0.7 (docs/patterns.md). */
static const iqfoc_pattern_row_t nine_row = {
    -1, 0, {IQ24(0.01816), IQ24(0.19656), IQ24(0.2125), IQ24(0.24245)}};
static const iqfoc_pattern_t nine = {&nine_row, 1, 4, IQ24(0.3), IQ24_ONE};
static iqfoc_pattern_control_t pattern_control;
static iq24_t pattern_theta;
static uint32_t pattern_cycles;
static const iqfoc_dq_t rated = {0, IQ24_ONE};
static const iqfoc_pulse_level_t pulse_levels[2] = {{NULL, 0, 0, 0, 0},
                                                    {&nine, IQ24(0.03), IQ24(0.02), 0, 0}};
static const iqfoc_pulse_config_t pulse_config = {pulse_levels, 2, 17000};
static iqfoc_pulse_mode_t pulse_mode;
static iqfoc_duties_t pulse_duties;
static iqfoc_cycle_t cycle;
static iqfoc_tuned_law_t tuned_law;
static iqfoc_tuned_t tuned;
static iqfoc_tuned_state_t tuned_state;
static iqfoc_watch_t watch;
static const iqfoc_adapt_config_t adapt_config = IQFOC_ADAPT_CONFIG;
static iqfoc_adapt_t adapt;
static const iqfoc_encoder_config_t encoder_config = {
    .counts_per_turn = 4096, .pole_pairs = 3, .index_known = true, .index_theta = 0};
static iqfoc_encoder_t encoder;
static const iqfoc_resolver_t resolver = {0, 0, IQ24_ONE, IQ24_ONE, IQ24(0.5), IQ24(1.5), 3, 0};
static const iqfoc_halls_config_t halls_config = IQFOC_HALLS(300);
static iqfoc_halls_t halls;
static const iqfoc_tracker_config_t tracker_config = IQFOC_TRACKER_GAINS(600.0, 2e-4, IQ24(0.5), UINT32_MAX);
static iqfoc_tracker_t tracker;
static iqfoc_observer_config_t observer_config =
    IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 5e-3, 0.12, 2e-4, 10.0, 300.0, 800.0, IQ24(0.005));
static iqfoc_observer_t observer;
static iqfoc_observer_inductance_config_t inductance_config = {IQ24(0.05), IQ24(0.0625), 0, 1, 0};
static iqfoc_observer_inductance_t inductance;
static const iqfoc_observer_resistance_config_t resistance_config = {IQ24(0.05), IQ24(0.5), IQ24(0.05)};
static iqfoc_observer_config_t resistance_adapted;
static iqfoc_observer_resistance_t resistance;
static iqfoc_sensorless_t sensorless;
static const iqfoc_extension_t dead_time = {.k_u = IQ24_ONE, .v_dead = IQ24(0.01)};
static iqfoc_ab_t current[3]; /* at the cycle's start, middle and end */
static const iqfoc_watch_angle_config_t watch_angle_config =
    IQFOC_WATCH_ANGLE_CONFIG(3, 1, 0.006, 0.001, 0.0004);
static iqfoc_watch_angle_t watch_angle;
static iqfoc_sample_t sample;
static const iqfoc_shunts_t shunts = {IQ24(0.9)};
static const iqfoc_offset_limits_t offset_limits = {
    .settle = 1, .count_log2 = 14, .offset_max = IQ24(0.2), .noise_max = IQ24(0.1)};
static iqfoc_offset_t offset;
static const iqfoc_commission_config_t commission_config = {
    .offset = {.settle = 0, .count_log2 = 2, .offset_max = IQ24(1.0), .noise_max = IQ24(0.125)},
    .start = {IQ24(0.5), 1000, 1000, IQ24(0.01), 1000},
    .i_max = IQ24(4.0),
    .speed_max = IQ24(1.0 / 3.0 - 1e-6),
    .u_max = IQ24(0.5),
    .cycles_max = UINT32_MAX,
    .settle_cycles = 1000,
    .block_log2 = 6,
    .half_log2 = 1};
static iqfoc_commission_t commission;
static const iqfoc_start_config_t start_config = {.i_align = IQ24(0.4),
                                                  .ramp_cycles = 500,
                                                  .hold_cycles = 500,
                                                  .speed_end = IQ24(0.02),
                                                  .run_up_cycles = 1000};
static iqfoc_start_t start;
static const iqfoc_speed_control_config_t speed_control_config =
    IQFOC_SPEED_CONTROL(40.0, 2e-3, 3, 0.134, 2e-4, 15.0, 4000.0, 20.0, 1);
static iqfoc_speed_control_t speed_control;
static const iqfoc_synchronous_level_t carrier_levels[3] = {
    {21, 0, 0}, {15, IQ24(0.06), IQ24(0.05)}, {9, IQ24(0.1), IQ24(0.09)}};
static const iqfoc_synchronous_config_t carrier_config = {carrier_levels, 3,        17000,       8500,
                                                          68000,          IQ24_ONE, IQ24(0.125), 0};
static iqfoc_synchronous_carrier_t carrier;
static iqfoc_cycle_config_t carrier_base;
static iqfoc_cycle_config_t carrier_set;
static iqfoc_cycle_t carrier_cycle;
static const iqfoc_supervision_config_t supervision_config = {IQ24(0.05), IQ24(0.125), 12, 5, IQ24(0.3), 10};
static iqfoc_supervision_t supervision;
static const iqfoc_restart_config_t restart_config = {1, 5, 3, 20};
static iqfoc_restart_t restart;
static int32_t recorded[4];
static const iqfoc_recorder_config_t recorder_config = {
    .channels = {IQFOC_RECORDER_IQ24(&recorded[0], IQFOC_RECORDER_I_A, 10.0, 27),
                 IQFOC_RECORDER_IQ24(&recorded[1], IQFOC_RECORDER_I_B, 10.0, 27),
                 IQFOC_RECORDER_IQ24(&recorded[2], IQFOC_RECORDER_I_C, 10.0, 27),
                 IQFOC_RECORDER_IQ24(&recorded[3], IQFOC_RECORDER_THETA_E, 6.28, 28)},
    .channel_count = 4,
    .decimation = 1,
    .period_mantissa = 1,
    .period_shift = 13,
    .trigger = IQFOC_RECORDER_NOW,
};
static int32_t recorder_memory[50];
static iqfoc_recorder_t recorder;

/* The Halls' bits of a sector, from the top bits of the angle. */
static uint32_t bits_of(iq24_t theta)
{
    static const uint32_t bits[8] = {1, 3, 2, 2, 6, 4, 5, 5};
    return bits[(uint32_t)theta >> 21 & 7];
}

static iqfoc_abc_t duties_of(const bench_input_t *in)
{
    const iqfoc_abc_t duties = {iq24_abs_sat(in->u.alpha), iq24_abs_sat(in->u.beta),
                                iq24_abs_sat(in->u.alpha + in->u.beta) / 2};
    return duties;
}

COUNT(overmodulation, iqfoc_duties_t, iqfoc_overmodulate,
      (iqfoc_overmodulation_t *, iqfoc_ab_t, iq24_t, iq24_t), (&over, in->u, in->u_dc_inverse, over_limit))
COUNT(reference, iqfoc_dq_t, iqfoc_reference_step,
      (iqfoc_reference_t *, const iqfoc_reference_config_t *, iq24_t, iqfoc_dq_t, iq24_t),
      (&reference, &reference_config, in->i_ref.q, in->u_steady, in->sample.u_dc / 2))
COUNT(six_step_by_timer, iqfoc_six_step_command_t, iqfoc_cycle_six_step_switch,
      (iqfoc_six_step_t *, iqfoc_cycle_t *, const iqfoc_sample_t *, uint32_t),
      (&six_step, &cycle, &in->sample, in->sample.time))
COUNT(pattern, void, iqfoc_pattern_step,
      (iqfoc_pattern_modulator_t *, iq24_t, iq24_t, iq24_t, iqfoc_pattern_edges_t *),
      (&pattern, in->sample.theta, in->sample.speed, IQ24(0.55) + iq24_abs_sat(in->u.alpha) / 16,
       pattern_edges))
COUNT(pattern_control_aim, void, iqfoc_pattern_control_aim, (iqfoc_pattern_control_t *, iqfoc_dq_t, iq24_t),
      (&pattern_control, rated, IQ24(0.025)))
COUNT(pattern_control_step, void, iqfoc_pattern_control_step,
      (iqfoc_pattern_control_t *, iqfoc_ab_t, iq24_t, iq24_t, iqfoc_pattern_edges_t *),
      (&pattern_control, pattern_control.i_next, pattern_theta, IQ24_ONE, pattern_edges))
COUNT(edges_of_pattern, void, iqfoc_edges_of_pattern,
      (const iqfoc_pattern_edges_t *, uint32_t, iqfoc_edges_t *), (pattern_edges, 17000, &edges))
COUNT(edges_of_duties, void, iqfoc_edges_of_duties, (iqfoc_abc_t, uint32_t, iqfoc_edges_t *),
      (duties_of(in), 17000, &edges))
COUNT(pulse_mode_step, void, iqfoc_pulse_mode_step,
      (iqfoc_pulse_mode_t *, iqfoc_pattern_control_t *, iq24_t, iq24_t),
      (&pulse_mode, &pattern_control, IQ24(0.025), 0))
COUNT(pulse_mode_to_pattern, bool, iqfoc_pulse_mode_to_pattern,
      (iqfoc_pulse_mode_t *, iqfoc_pattern_control_t *, const iqfoc_cycle_t *, iqfoc_abc_t, iq24_t,
       iqfoc_pattern_edges_t *),
      (&pulse_mode, &pattern_control, &carrier_cycle, duties_of(in), IQ24_ONE, pattern_edges))
COUNT(pulse_mode_to_carrier, bool, iqfoc_pulse_mode_to_carrier,
      (iqfoc_pulse_mode_t *, iqfoc_pattern_control_t *, iqfoc_cycle_t *, const iqfoc_cycle_config_t *,
       iqfoc_ab_t, iq24_t, iq24_t, iqfoc_pattern_edges_t *, iqfoc_duties_t *),
      (&pulse_mode, &pattern_control, &carrier_cycle, &carrier_set, pattern_control.i_next, pattern_theta,
       IQ24_ONE, pattern_edges, &pulse_duties))
COUNT(pulse_mode_resume, void, iqfoc_pulse_mode_resume, (const iqfoc_pattern_control_t *, iqfoc_cycle_t *),
      (&pattern_control, &carrier_cycle))
COUNT(tuned_at_speed, iqfoc_tuned_t, iqfoc_tuned_at_speed, (const iqfoc_tuned_law_t *, iq24_t),
      (&tuned_law, in->sample.speed))
COUNT(tuned_step, iqfoc_ab_t, iqfoc_tuned_step,
      (iqfoc_tuned_state_t *, const iqfoc_tuned_t *, iqfoc_ab_t, iqfoc_ab_t, iqfoc_dq_t, iq24_t),
      (&tuned_state, &tuned, in->i, in->u, in->i_ref, in->sample.theta))
COUNT(watch_step, bool, iqfoc_watch_step,
      (iqfoc_watch_t *, iqfoc_ab_t, iqfoc_dq_t, iqfoc_dq_t, iq24_sincos_t),
      (&watch, in->i, in->i_ref, in->i_ref, in->sc))
COUNT(watch_block, bool, iqfoc_watch_block, (iqfoc_watch_t *, const iqfoc_watch_config_t *, iq24_t, iq24_t),
      (&watch, &bench_watch, in->sample.speed, in->sample.theta))
COUNT(adapt_block, void, iqfoc_adapt_block,
      (iqfoc_adapt_t *, const iqfoc_adapt_config_t *, const iqfoc_watch_t *, const iqfoc_watch_config_t *,
       iq24_t),
      (&adapt, &adapt_config, &watch, &bench_watch, in->sample.speed))
COUNT(adapt_law, iqfoc_tuned_law_t, iqfoc_adapt_law, (const iqfoc_tuned_law_t *, const iqfoc_adapt_t *),
      (&tuned_law, &adapt))
COUNT(encoder, iq24_t, iqfoc_encoder_theta, (const iqfoc_encoder_t *, uint32_t),
      (&encoder, (uint32_t)in->sample.theta & 4095))
COUNT(resolver, iqfoc_resolver_angle_t, iqfoc_resolver_read, (const iqfoc_resolver_t *, iq24_t, iq24_t),
      (&resolver, in->sc.sin, in->sc.cos))
COUNT(halls, void, iqfoc_halls_step, (iqfoc_halls_t *, uint32_t, uint32_t),
      (&halls, bits_of(in->sample.theta), 100))
COUNT(tracker, void, iqfoc_tracker_step, (iqfoc_tracker_t *, iq24_t, iq24_t, bool),
      (&tracker, in->sample.theta, IQ24(0.1), true))
COUNT(observer, void, iqfoc_observer_step, (iqfoc_observer_t *, iqfoc_ab_t, iqfoc_ab_t, iqfoc_ab_t),
      (&observer, in->u, in->i, in->i))
COUNT(observer_inductance, void, iqfoc_observer_inductance_step,
      (iqfoc_observer_inductance_t *, const iqfoc_observer_t *, iqfoc_ab_t), (&inductance, &observer, in->i))
COUNT(observer_resistance, void, iqfoc_observer_resistance_step,
      (iqfoc_observer_resistance_t *, iqfoc_observer_t *, iqfoc_ab_t), (&resistance, &observer, in->i))
COUNT(watch_angle, bool, iqfoc_watch_angle_step, (iqfoc_watch_angle_t *, const iqfoc_sensorless_t *),
      (&watch_angle, &sensorless))
COUNT(watch_angle_block, bool, iqfoc_watch_angle_step, (iqfoc_watch_angle_t *, const iqfoc_sensorless_t *),
      (&watch_angle, &sensorless))
COUNT(shunts, iqfoc_shunts_currents_t, iqfoc_shunts_read,
      (const iqfoc_shunts_t *, iqfoc_abc_t, iqfoc_abc_t, iqfoc_abc_t),
      (&shunts, in->sample.i, duties_of(in), in->sample.i_mean))
COUNT(speed_control, iq24_t, iqfoc_speed_control_step, (iqfoc_speed_control_t *, iq24_t, iq24_t, iq24_t),
      (&speed_control, IQ24(0.1), in->sample.speed, IQ24(1.0)))
COUNT(synchronous_carrier, uint32_t, iqfoc_synchronous_carrier_step,
      (iqfoc_synchronous_carrier_t *, iq24_t, iq24_t), (&carrier, in->sample.theta, in->sample.speed))
COUNT(synchronous_set, void, iqfoc_synchronous_carrier_set,
      (const iqfoc_cycle_config_t *, uint32_t, iqfoc_cycle_config_t *), (&carrier_base, 15000, &carrier_set))
COUNT(synchronous_flux, void, iqfoc_synchronous_carrier_keep_flux,
      (iqfoc_synchronous_carrier_t *, iqfoc_cycle_t *), (&carrier, &carrier_cycle))
COUNT(commission, iqfoc_command_t, iqfoc_commission_step, (iqfoc_commission_t *, const iqfoc_sample_t *),
      (&commission, &in->sample))
COUNT(commission_line, iqfoc_command_t, iqfoc_commission_step, (iqfoc_commission_t *, const iqfoc_sample_t *),
      (&commission, &in->sample))
COUNT(offset, iqfoc_offset_verdict_t, iqfoc_offset_step, (iqfoc_offset_t *, iqfoc_abc_t),
      (&offset, in->sample.i))
COUNT(start, void, iqfoc_start_step, (iqfoc_start_t *, iq24_t), (&start, in->sample.theta))
COUNT(supervision, uint32_t, iqfoc_supervision_step, (iqfoc_supervision_t *, iqfoc_abc_t, iq24_t, bool),
      (&supervision, in->sample.i, in->sample.speed, true))
COUNT(restart, iqfoc_restart_action_t, iqfoc_restart_step, (iqfoc_restart_t *, uint32_t),
      (&restart, (uint32_t)in->sample.theta >> 27 & 1))

COUNT(recorder, void, iqfoc_recorder_take, (iqfoc_recorder_t *, uint32_t),
      (&recorder, (uint32_t)in->sample.theta >> 27 & 1))
COUNT(sensorless_acting, iqfoc_ab_t, iqfoc_sensorless_acting,
      (const iqfoc_extension_t *, const iqfoc_flux_predictor_t *, iqfoc_ab_t, iq24_t, const iqfoc_ab_t *),
      (&dead_time, &observer_config.machine, in->u, in->u_dc_inverse, current))
COUNT(sensorless, void, iqfoc_sensorless_valley, (iqfoc_sensorless_t *, iqfoc_cycle_t *, iqfoc_sample_t *),
      (&sensorless, &cycle, &sample))

/* Locked and within its limits, as in a drive that runs. */
static uint32_t count_observer_locked(const bench_input_t *in)
{
    iqfoc_observer_start(&observer, in->i, in->sample.theta, in->sample.speed, true);
    return count_observer(in);
}

/* After a step of the current, so that l_q is adapted. */
static uint32_t count_inductance_adapted(const bench_input_t *in)
{
    observer.locked = true;
    inductance.follows = true;
    inductance.level = IQ24(-8.0);
    return count_observer_inductance(in);
}

/* Locked, with the memory of a current along the magnet, so that R is adapted. */
static uint32_t count_resistance_adapted(const bench_input_t *in)
{
    iqfoc_observer_start(&observer, in->i, in->sample.theta, in->sample.speed, true);
    resistance.s.alpha = 4 * in->sc.cos;
    resistance.s.beta = 4 * in->sc.sin;
    return count_observer_resistance(in);
}

static uint32_t count_acting_in_cycle(const bench_input_t *in)
{
    current[0] = in->i;
    current[1].alpha = in->i.alpha + in->delta.alpha;
    current[1].beta = in->i.beta + in->delta.beta;
    current[2] = in->i;
    return count_sensorless_acting(in);
}

static uint32_t count_sensorless_locked(const bench_input_t *in)
{
    sample = in->sample;
    sensorless.on = 3;
    sensorless.source = IQFOC_ANGLE_OBSERVED;
    sensorless.wanted = IQFOC_ANGLE_OBSERVED;
    iqfoc_observer_start(&sensorless.observer, in->i, sample.theta, sample.speed, true);
    return count_sensorless(in);
}

/* A drive in one of its phases, `in_block` cycles of its last block measured. */
static void begin_commission(iqfoc_commission_phase_t phase, uint32_t in_block)
{
    (void)iqfoc_commission_init(&commission, &commission_config);
    commission.phase = phase;
    commission.start.stage = IQFOC_START_OPEN_LOOP;
    commission.start.speed = IQ24(0.01);
    commission.start.i_ref.d = IQ24(0.5);
    commission.in_block = in_block;
    commission.blocks = IQFOC_COMMISSION_BLOCKS - 1;
    for (int32_t k = 0; k < IQFOC_COMMISSION_BLOCKS; k++) {
        commission.x[k] = IQ24(0.1) * (2 + k / 8) + k % 3;
        commission.y[k] = IQ24(0.003) * (2 + k / 8) + k % 5;
    }
    commission.sum[0] = 63 * INT64_C(8388608);
    commission.sum[1] = 63 * INT64_C(251658);
    commission.l_rough = IQ24(0.5);
    commission.gains.kp_d = IQ24(0.2);
    commission.gains.kp_q = IQ24(0.2);
    commission.gains.ki_d = IQ24(0.01);
    commission.gains.ki_q = IQ24(0.01);
}

static uint32_t count_commission_in_block(const bench_input_t *in)
{
    begin_commission(IQFOC_COMMISSION_SPIN, 1);
    return count_commission(in);
}

/* The staircase's last cycle: the line through 32 blocks. */
static uint32_t count_commission_at_end(const bench_input_t *in)
{
    begin_commission(IQFOC_COMMISSION_STAIRCASE, 63);
    return count_commission_line(in);
}

static void begin_watch_angle(const bench_input_t *in)
{
    sensorless.on = 3;
    iqfoc_observer_start(&sensorless.observer, in->i, in->sample.theta, in->sample.speed, true);
    sensorless.difference = in->delta.alpha / 256;
    iqfoc_watch_angle_reset(&watch_angle);
    watch_angle.theta = in->sample.theta;
    watch_angle.count = 1;
}

static uint32_t count_watch_angle_in_block(const bench_input_t *in)
{
    begin_watch_angle(in);
    return count_watch_angle(in);
}

/* The end of the block after which an eccentricity gets its name. */
static uint32_t count_watch_angle_at_end(const bench_input_t *in)
{
    begin_watch_angle(in);
    watch_angle.count = 100;
    watch_angle.path = 3 * IQ24_ONE;
    watch_angle.wait = 0;
    watch_angle.sum[1] = INT64_C(100000000);
    watch_angle.sum[2] = -INT64_C(70000000);
    watch_angle.alarm = IQFOC_WATCH_ANGLE_ECCENTRIC;
    watch_angle.naming = 1;
    return count_watch_angle_block(in);
}

/* A row with room in the memory, as in a recording that the line keeps up with. */
static uint32_t count_recorder_with_room(const bench_input_t *in)
{
    recorded[0] = in->sample.i.a;
    recorded[1] = in->sample.i.b;
    recorded[2] = in->sample.i.c;
    recorded[3] = in->sample.theta;
    iqfoc_recorder_arm(&recorder);
    return count_recorder(in);
}

/* 250 Hz at 10 kHz, with steps between the rated current and 30 % of it; the current is as predicted. */
static uint32_t count_pattern_control_turning(const bench_input_t *in)
{
    pattern_theta = (pattern_theta + IQ24(0.025)) & (IQ24_ONE - 1);
    pattern_cycles++;
    const iqfoc_dq_t low = {0, IQ24(0.3)};
    iqfoc_pattern_control_aim(&pattern_control, pattern_cycles / 64 % 2 == 0 ? rated : low, IQ24(0.025));
    return count_pattern_control_step(in);
}

/* The edges of the cycles that the control gives. */
static uint32_t count_edges_of_control(const bench_input_t *in)
{
    (void)count_pattern_control_turning(in);
    return count_edges_of_pattern(in);
}

/* A hand-over that is taken at once: from the carrier, and back. */
static uint32_t count_pulse_mode_to_pattern_now(const bench_input_t *in)
{
    const iqfoc_ab_t near = {in->i.alpha / 2, in->i.beta / 2};
    carrier_cycle.i_next = near;
    carrier_cycle.theta_valley = in->sample.theta;
    pulse_mode.level = 0;
    pulse_mode.wanted = 1;
    pulse_mode.speed = IQ24(0.025);
    pulse_mode.waited = IQ24(2.0);
    return count_pulse_mode_to_pattern(in);
}

static uint32_t count_pulse_mode_to_carrier_now(const bench_input_t *in)
{
    pattern_theta = (pattern_theta + IQ24(0.025)) & (IQ24_ONE - 1);
    iqfoc_pattern_control_aim(&pattern_control, rated, IQ24(0.025));
    pulse_mode.level = 1;
    pulse_mode.wanted = 0;
    pulse_mode.speed = IQ24(0.025);
    pulse_mode.waited = IQ24(2.0);
    return count_pulse_mode_to_carrier(in);
}

/* The sums of a block of a drive whose model fits, so that no alarm ends the work: errors of some thousandths. */
static void sum_block(const bench_input_t *in)
{
    const iqfoc_ab_t off = {in->delta.alpha / 256, in->delta.beta / 256};
    iqfoc_watch_reset(&watch);
    watch.blocks = 1; /* the first is not judged */
    watch.speed = in->sample.speed;
    for (uint32_t k = 0; k < IQFOC_WATCH_BLOCK_CYCLES; k++) {
        (void)iqfoc_watch_step(&watch, off, in->i_ref, in->u_steady, in->sc);
    }
}

static uint32_t count_watch_block_of_drive(const bench_input_t *in)
{
    sum_block(in);
    return count_watch_block(in);
}

static uint32_t count_adapt_block_of_drive(const bench_input_t *in)
{
    sum_block(in);
    return count_adapt_block(in);
}

static void begin(void)
{
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(IQ24(0.08));
    const iqfoc_sample_t still = {.speed = IQ24(0.08), .u_dc = IQ24_ONE};
    over_limit = iqfoc_overmodulation_limit(&rotor);
    tuned_law = (iqfoc_tuned_law_t){bench_salient, IQ24(0.5), IQ24(0.5), IQ24(0.25), IQ24(0.05)};
    tuned = iqfoc_tuned_at_speed(&tuned_law, IQ24(0.08));
    iqfoc_watch_reset(&watch);
    (void)iqfoc_cycle_init(&cycle, &bench_config);
    cycle.enabled = true;
    (void)iqfoc_cycle_six_step_begin(&six_step, &cycle, &six_step_config, IQ24(0.25), &still);
    const iqfoc_pattern_control_config_t pattern_config = {
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 1e-4, 14.849, 565.0), IQ24(0.1), IQ24(0.01)};
    (void)iqfoc_pattern_control_init(&pattern_control, &pattern_config, &nine, IQ24(0.05));
    (void)iqfoc_pulse_mode_init(&pulse_mode, &pulse_config);
    (void)iqfoc_pattern_init(&pattern, &pattern_table, IQ24(0.03));
    (void)iqfoc_encoder_init(&encoder, &encoder_config);
    (void)iqfoc_halls_init(&halls, &halls_config);
    (void)iqfoc_tracker_init(&tracker, &tracker_config);
    observer_config.angle_max = IQ24(0.5);
    observer_config.flux_max = IQ24(7.9);
    observer_config.speed_min = 0;
    (void)iqfoc_observer_init(&observer, &observer_config);
    inductance_config.high = observer_config.machine.l_q;
    (void)iqfoc_observer_inductance_init(&inductance, &inductance_config, &observer_config);
    resistance_adapted = observer_config;
    (void)iqfoc_observer_resistance_init(&resistance, &resistance_config, &resistance_adapted);
    (void)iqfoc_sensorless_init(&sensorless, &observer_config, NULL, NULL);
    (void)iqfoc_watch_angle_init(&watch_angle, &watch_angle_config);
    (void)iqfoc_offset_init(&offset, &offset_limits);
    (void)iqfoc_speed_control_init(&speed_control, &speed_control_config);
    (void)iqfoc_synchronous_carrier_init(&carrier, &carrier_config);
    carrier_base = bench_config;
    carrier_base.period_ticks = 17000;
    iqfoc_synchronous_carrier_set(&carrier_base, 15000, &carrier_set);
    carrier_cycle.config = &carrier_base;
    carrier_cycle.next = &carrier_set;
    carrier_cycle.rotor.speed = IQ24(0.1);
    carrier_cycle.i_ref = rated;
    (void)iqfoc_start_init(&start, &start_config);
    (void)iqfoc_supervision_init(&supervision, &supervision_config);
    (void)iqfoc_restart_init(&restart, &restart_config);
    (void)iqfoc_recorder_init(&recorder, &recorder_config, recorder_memory, 50);
}

void bench_services(void)
{
    begin();
    bench_report("overmodulation", count_overmodulation);
    bench_report("reference", count_reference);
    bench_report("six_step_by_timer", count_six_step_by_timer);
    bench_report("pattern", count_pattern);
    bench_report("pattern_control_aim", count_pattern_control_aim);
    bench_report("pattern_control_step", count_pattern_control_turning);
    bench_report("edges_of_pattern", count_edges_of_control);
    bench_report("edges_of_duties", count_edges_of_duties);
    bench_report("tuned_at_speed", count_tuned_at_speed);
    bench_report("tuned_step", count_tuned_step);
    bench_report("watch_step", count_watch_step);
    bench_report("watch_block", count_watch_block_of_drive);
    bench_report("adapt_block", count_adapt_block_of_drive);
    bench_report("adapt_law", count_adapt_law);
    bench_report("encoder", count_encoder);
    bench_report("resolver", count_resolver);
    bench_report("halls", count_halls);
    bench_report("tracker", count_tracker);
    bench_report("observer", count_observer_locked);
    bench_report("observer_inductance", count_inductance_adapted);
    bench_report("observer_resistance", count_resistance_adapted);
    bench_report("sensorless", count_sensorless_locked);
    bench_report("sensorless_acting", count_acting_in_cycle);
    bench_report("watch_angle", count_watch_angle_in_block);
    bench_report("watch_angle_block", count_watch_angle_at_end);
    bench_report("shunts", count_shunts);
    bench_report("offset", count_offset);
    bench_report("commission", count_commission_in_block);
    bench_report("commission_line", count_commission_at_end);
    bench_report("speed_control", count_speed_control);
    bench_report("synchronous_carrier", count_synchronous_carrier);
    bench_report("synchronous_set", count_synchronous_set);
    bench_report("synchronous_flux", count_synchronous_flux);
    bench_report("pulse_mode_step", count_pulse_mode_step);
    bench_report("pulse_mode_to_pattern", count_pulse_mode_to_pattern_now);
    bench_report("pulse_mode_to_carrier", count_pulse_mode_to_carrier_now);
    bench_report("pulse_mode_resume", count_pulse_mode_resume);
    bench_report("start", count_start);
    bench_report("supervision", count_supervision);
    bench_report("restart", count_restart);
    bench_report("recorder", count_recorder_with_room);
}

/*
 * Sensors and supervision of the drive. For functions that sum over many calls, the state is any that their own
 * counts allow, and one more call is proved.
 */
#include "any_drive.h"

#include "iqfoc/adapt.h"
#include "iqfoc/commission.h"
#include "iqfoc/halls.h"
#include "iqfoc/observer_inductance.h"
#include "iqfoc/observer_resistance.h"
#include "iqfoc/offset.h"
#include "iqfoc/speed_control.h"
#include "iqfoc/supervision.h"
#include "iqfoc/synchronous_carrier.h"
#include "iqfoc/tracker.h"
#include "iqfoc/watch.h"
#include "iqfoc/watch_angle.h"

/* Offset calibration: any limits that are not refused, any samples; sums of all deviations but
 * the last before each. */
void prove_offset(void)
{
    const iqfoc_offset_limits_t whatever = {any_count(0, UINT32_MAX), any_count(0, UINT32_MAX), any(), any()};
    iqfoc_offset_t o;
    (void)iqfoc_offset_init(&o, &whatever);
    for (uint32_t count_log2 = 2; count_log2 <= 16; count_log2++) {
        const iqfoc_offset_limits_t limits = {any_count(0, UINT32_MAX), count_log2, any(), any()};
        const int32_t before = (1 << count_log2) - 1;
        if (iqfoc_offset_init(&o, &limits) == IQFOC_OK) {
            const iqfoc_offset_sums_t sums = {
                any(), (int64_t)any_within(-(1 << 21), 1 << 21) * before,
                (int64_t)any_within(0, 1 << 21) * any_within(0, 1 << 21) * before, any_bool()};
            o.seen = any_count(0, UINT32_MAX - 1);
            o.a = sums;
            o.b = sums;
            o.c = sums;
            (void)iqfoc_offset_step(&o, any_abc(IQ24_MIN, IQ24_MAX));
            (void)iqfoc_offset_removed(&o, any_abc(IQ24_MIN, IQ24_MAX));
        }
    }
}

/* Halls: any configuration that is not refused, any bits, any capture, from any state. */
void prove_halls(void)
{
    const iqfoc_halls_config_t config = {{any(), any(), any(), any(), any(), any()},
                                         any_count(0, UINT32_MAX)};
    iqfoc_halls_t h;
    if (iqfoc_halls_init(&h, &config) == IQFOC_OK) {
        h.theta = any();
        h.speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        h.sector = any_within(-1, 5);
        h.way = any_within(-1, 1);
        h.since = any_count(0, (1 << 28) + 255);
        h.count = any_count(0, 6);
        h.next = any_count(0, 5);
        for (int32_t k = 0; k < IQFOC_HALLS_SECTORS; k++) {
            h.span[k] = any_count(1, (1 << 28) + 255);
        }
        h.speed_seen = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        iqfoc_halls_step(&h, any_count(0, UINT32_MAX), any_count(0, UINT32_MAX));
    }
}

/* Tracker: any configuration that is not refused, any measurement, from any state; its angle 8 cycles off. */
void prove_tracker(void)
{
    const iqfoc_tracker_config_t config = {any(), any(), any(), any(), any_count(0, UINT32_MAX)};
    iqfoc_tracker_t t;
    if (iqfoc_tracker_init(&t, &config) == IQFOC_OK) {
        t.theta_q32 = any();
        t.speed_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        t.acceleration_q32 = any_within(-(1 << 29), 1 << 29);
        t.error = any();
        t.missing = any_count(0, UINT32_MAX);
        t.seen = any_count(0, 2);
        t.lost = any_bool();
        iqfoc_tracker_step(&t, any(), any_within(-IQ24_ONE, IQ24_ONE), any_bool());
        (void)iqfoc_tracker_theta(&t, any_within(-8 * IQ24_ONE, 8 * IQ24_ONE));
        (void)iqfoc_tracker_speed(&t);
    }
}

/* Observer: any configuration within observer.h, |u| <= 2 and |i| <= 15.9 a component, from any state. */
void prove_observer(void)
{
    const iq24_t l_min = IQ24(0.0625);
    const iqfoc_observer_config_t config = {{any_within(l_min, IQ24(8.0)), any_within(l_min, IQ24(8.0)),
                                             any(), any(), any_within(0, IQ24_ONE), any_within(0, IQ24(16.0)),
                                             any()},
                                            any_within(0, IQ24(4.0)),
                                            any_within(IQ24(0.125), IQ24_ONE),
                                            any_within(1, IQ24_ONE),
                                            any_within(1, IQ24(0.25)),
                                            any_within(0, IQFOC_ROTOR_SPEED_MAX),
                                            any_within(1, IQ24(0.5)),
                                            any_within(1, IQ24(8.0) - 1),
                                            any_count(1, UINT32_MAX),
                                            any_count(0, UINT32_MAX),
                                            any_count(0, UINT32_MAX)};
    iqfoc_observer_t o;
    if (iqfoc_observer_init(&o, &config) == IQFOC_OK) {
        iqfoc_observer_start(&o, any_ab(IQ24(15.9)), any(), any(), any_bool());
        o.psi = any_ab(IQ24(32.0));
        o.theta_q32 = any();
        o.speed_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        o.count = any_count(0, UINT32_MAX);
        o.slow = any_count(0, UINT32_MAX);
        o.locked = any_bool();
        o.begins = any_bool();
        iqfoc_observer_step(&o, any_ab(IQ24(2.0)), any_ab(IQ24(15.9)), any_ab(IQ24(15.9)));
        (void)iqfoc_observer_mean(any_ab(IQ24(15.9)), any_ab(IQ24(15.9)), any_ab(IQ24(15.9)));
        (void)iqfoc_observer_theta(&o, any_within(-8 * IQ24_ONE, 8 * IQ24_ONE));
        (void)iqfoc_observer_speed(&o);
    }
}

/* L_q of the observer: any configuration that is not refused, any error and angle, |i| <= 15.9 a component, from any
 * state. */
void prove_observer_inductance(void)
{
    const iqfoc_observer_config_t nominal =
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.004));
    const iqfoc_observer_inductance_config_t config = {any(), any(), any(), any(), any()};
    iqfoc_observer_inductance_t a;
    iqfoc_observer_t o;
    if (iqfoc_observer_inductance_init(&a, &config, &nominal) == IQFOC_OK &&
        iqfoc_observer_init(&o, &a.adapted) == IQFOC_OK) {
        o.theta_q32 = any();
        o.speed_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        o.error = any_within(IQ24(-0.5), IQ24(0.5));
        o.locked = any_bool();
        a.adapted.k1 = any_within(1, IQ24_ONE);
        a.adapted.k2 = any_within(1, IQ24(0.25));
        a.adapted.machine.psi = any_within(IQ24(0.015625), IQ24(16.0));
        a.adapted.machine.l_q = any_within(1, IQ24(8.0));
        a.level = any_within(IQ24(-16.0), IQ24(16.0));
        a.slope = any_within(IQ24(-8.0), IQ24(8.0));
        a.follows = any_bool();
        iqfoc_observer_inductance_step(&a, &o, any_ab(IQ24(15.9)));
    }
}

/* R and psi_f of the observer: any shares and gain within observer_resistance.h, |i| <= 15.9 a component, from any state. */
void prove_observer_resistance(void)
{
    iqfoc_observer_config_t adapted =
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.004));
    const iqfoc_observer_resistance_config_t whatever = {any(), any(), any()};
    const iqfoc_observer_resistance_config_t config = {
        any_within(1, IQ24_ONE), any_within(IQ24(0.0625), IQ24(0.5)), any_within(IQ24(0.015625), IQ24(0.25))};
    iqfoc_observer_t o;
    iqfoc_observer_resistance_t a;
    (void)iqfoc_observer_resistance_init(&a, &whatever, &adapted);
    if (iqfoc_observer_init(&o, &adapted) == IQFOC_OK) {
        a.config = &config;
        a.adapted = &adapted;
        a.r_nominal = any_within(0, IQ24_ONE);
        a.psi_nominal = any_within(IQ24(0.015625), IQ24(16.0));
        a.r_over_psi = any_within(0, IQ24(8.0));
        a.psi_inverse = any_within(IQ24(0.0625), IQ24(64.0));
        a.least = any_within(IQ24(0.03125), IQ24(4.0));
        a.r = any_within(-IQ24(0.5), IQ24(0.5));
        a.psi = any_within(-IQ24(0.25), IQ24(0.25));
        a.s = any_ab(IQ24(32.0));
        o.theta_q32 = any();
        o.speed_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        o.flux_error = any_within(-IQ24(8.0), IQ24(8.0));
        o.psi = any_ab(IQ24(32.0));
        o.locked = any_bool();
        iqfoc_observer_resistance_step(&a, &o, any_ab(IQ24(15.9)));
    }
}

/* Speed control: any configuration that is not refused, any speeds and limit, from any state of the header. */
void prove_speed_control(void)
{
    const iqfoc_speed_control_config_t config = {any(), any(), any(), any(), any(), any_count(0, UINT32_MAX)};
    iqfoc_speed_control_t c;
    if (iqfoc_speed_control_init(&c, &config) == IQFOC_OK) {
        iqfoc_speed_control_start(&c, any(), any());
        c.integral = iq24_acc_mul(any_within(-IQ24(8.0) - 1, IQ24(8.0)), IQ24_ONE) + any_within(0, IQ24_ONE);
        c.set_point_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        c.wait = any_count(0, UINT32_MAX);
        (void)iqfoc_speed_control_step(&c, any(), any(), any());
    }
}

/* Synchronous carrier: any configuration that is not refused, any angle and speed, from any state of the header. */
void prove_synchronous_carrier(void)
{
    static iqfoc_synchronous_level_t level[IQFOC_SYNCHRONOUS_LEVELS_MAX];
    const iqfoc_synchronous_config_t whatever = {
        level, any(), any_count(0, UINT32_MAX), any_count(0, UINT32_MAX), any_count(0, UINT32_MAX), any(),
        any(), any()};
    iqfoc_synchronous_carrier_t c;
    for (int32_t n = 0; n < IQFOC_SYNCHRONOUS_LEVELS_MAX; n++) {
        level[n].periods = any();
        level[n].on = any();
        level[n].off = any();
    }
    (void)iqfoc_synchronous_carrier_init(&c, &whatever);
    for (int32_t n = 0; n < IQFOC_SYNCHRONOUS_LEVELS_MAX; n++) {
        level[n].periods = any_within(0, IQFOC_SYNCHRONOUS_PERIODS_MAX);
    }
    const iqfoc_synchronous_config_t config = {level,
                                               any_within(1, IQFOC_SYNCHRONOUS_LEVELS_MAX),
                                               any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX),
                                               any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX),
                                               any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX),
                                               any_within(1, IQ24_ONE),
                                               any_within(1, IQ24(0.25)),
                                               any()};
    c.config = &config;
    c.level = any_within(0, config.levels - 1);
    c.ticks = any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX);
    (void)iqfoc_synchronous_carrier_step(&c, any(), any());
}

/* The set for another period: any set that iqfoc_cycle_init accepts with a period below 2^24 ticks. */
void prove_synchronous_set(void)
{
    iqfoc_cycle_config_t base = any_set();
    iqfoc_cycle_config_t set;
    base.predictor.k_u = any_within(1, IQ24(16.0));
    base.period_ticks = any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX);
    iqfoc_synchronous_carrier_set(&base, any_count(0, UINT32_MAX), &set);
}

/* The kept flux at a change of the period: any speed, any voltage within 8, |i_ref| <= 32, any gains of the header. */
void prove_synchronous_flux(void)
{
    iqfoc_cycle_config_t old = any_set();
    iqfoc_cycle_config_t new = any_set();
    old.period_ticks = any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX);
    new.period_ticks = any_count(1, IQFOC_SYNCHRONOUS_TICKS_MAX);
    old.gains.kp_d = any_within(0, IQ24(32.0));
    old.gains.kp_q = any_within(0, IQ24(32.0));
    old.gains.x_d = any_within(0, IQ24(96.0));
    old.gains.x_q = any_within(0, IQ24(96.0));
    new.gains.x_d = any_within(0, IQ24(96.0));
    new.gains.x_q = any_within(0, IQ24(96.0));
    new.gains.emf = any_within(0, IQ24(96.0));
    iqfoc_cycle_t cycle = {.config = &old, .next = &new};
    cycle.rotor.speed = any_within(-IQFOC_ROTOR_SPEED_MAX - 1, IQFOC_ROTOR_SPEED_MAX);
    cycle.u_dq = any_dq(IQ24(8.0));
    cycle.i_ref = any_dq(IQ24(32.0));
    cycle.control.integral_d = iq24_acc_mul(any_within(-IQ24(8.0), IQ24(8.0)), IQ24_ONE);
    cycle.control.integral_q = iq24_acc_mul(any_within(-IQ24(8.0), IQ24(8.0)), IQ24_ONE);
    iqfoc_synchronous_carrier_t carrier = {0};
    carrier.mean_off = any_dq(IQ24_ONE);
    iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
}

/* Supervision: any configuration that is not refused, any currents; sums of at most 2^24 cycles before. */
void prove_supervision(void)
{
    const iqfoc_supervision_config_t config = {
        any(), any(), any_count(0, UINT32_MAX), any_count(0, UINT32_MAX), any(), any_count(0, UINT32_MAX)};
    iqfoc_supervision_t s;
    if (iqfoc_supervision_init(&s, &config) == IQFOC_OK) {
        const int64_t most = (int64_t)((1 << 24) - 1) * INT32_MAX;
        s.sum_a = any_bool() ? most : 0;
        s.sum_b = any_bool() ? most : 0;
        s.sum_c = any_bool() ? most : 0;
        s.angle = (int64_t)any_within(-IQ24_ONE, IQ24_ONE) * ((1 << 24) - 1);
        s.cycles = any_count(0, (1 << 24) - 1);
        s.bad_windows = any_count(0, 1 << 20);
        s.bad_sums = any_count(0, 1 << 20);
        (void)iqfoc_supervision_step(&s, any_abc(IQ24_MIN, IQ24_MAX), any_within(-IQ24_ONE, IQ24_ONE),
                                     any_bool());
    }
}

static iqfoc_watch_config_t any_watch(void)
{
    iqfoc_watch_config_t config;
    config.per_noise_q8 = any_within(10 * 256, 20000 * 256);
    for (int32_t n = 0; n < IQFOC_WATCH_GROUPS; n++) {
        config.size_q16[n] = any_within(0, 2048 * 65536 - 1);
    }
    config.mechanical = any_within(0, IQ24_ONE);
    config.noise_least = any_within(IQ24_ONE / 256, IQ24(0.04));
    config.flux_d_q16 = any_within(65536 / 8, 2 * 65536);
    config.flux_q_q16 = any_within(65536 / 8, 2 * 65536);
    config.slack_q16[0] = any_within(0, 64 * 65536);
    config.slack_q16[1] = any_within(0, 64 * 65536);
    for (int32_t n = 0; n < IQFOC_WATCH_UNSURE; n++) {
        config.unsure_q16[n] = any_within(0, 16 * 65536);
    }
    config.threshold_q16 = any_within(0, 1000 * 65536);
    config.naming_blocks = any_within(1, 1024);
    return config;
}

/* The watch's step: a block of at most 31 cycles before, any error, |i| <= 8, |u| <= 16. */
void prove_watch_step(void)
{
    iqfoc_watch_t w;
    iqfoc_watch_reset(&w);
    for (int32_t n = 0; n < IQFOC_WATCH_BLOCK_CYCLES; n++) {
        (void)iqfoc_watch_step(&w, any_ab(IQ24_MAX), any_dq(IQ24(8.0)), any_dq(IQ24(16.0)), any_sincos());
    }
}

/* The watch's block: any configuration within watch.h, any block, from any state of its detectors. */
void prove_watch_block(void)
{
    const iqfoc_watch_config_t config = any_watch();
    iqfoc_watch_t w;
    iqfoc_watch_reset(&w);
    for (int32_t n = 0; n < IQFOC_WATCH_BLOCK_CYCLES; n++) {
        (void)iqfoc_watch_step(&w, any_ab(IQ24_MAX), any_dq(IQ24(8.0)), any_dq(IQ24(16.0)), any_sincos());
    }
    w.speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    w.theta = any();
    w.mechanical = any();
    w.across_q6 = any();
    w.naming = (int16_t)any_within(0, 1024);
    for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        w.up_q16[n] = any_within(0, 16384 << 16);
        w.down_q16[n] = any_within(0, 16384 << 16);
        w.xy_q6[n] = any();
        w.xx_q6[n] = any();
    }
    w.blocks = any_count(0, UINT32_MAX - 1);
    w.since = any_count(0, UINT32_MAX);
    (void)iqfoc_watch_block(&w, &config, any(), any());
}

/* Resistance and magnet followed: any bounds within adapt.h, any block, any speed; the law with them, any machine. */
void prove_adapt(void)
{
    const iqfoc_watch_config_t config = any_watch();
    const iqfoc_adapt_config_t bounds = {any_within(0, IQ24_ONE), any_within(-IQ24(0.5), 0),
                                         any_within(0, IQ24_ONE), any_within(-IQ24(0.25), 0),
                                         any_within(0, IQ24(0.25))};
    iqfoc_watch_t w;
    iqfoc_watch_reset(&w);
    for (int32_t n = 0; n < IQFOC_WATCH_BLOCK_CYCLES; n++) {
        (void)iqfoc_watch_step(&w, any_ab(IQ24_MAX), any_dq(IQ24(8.0)), any_dq(IQ24(16.0)), any_sincos());
    }
    w.speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    w.blocks = any_count(1, UINT32_MAX);
    iqfoc_adapt_t adapt = {any_within(-IQ24(0.5), IQ24_ONE), any_within(-IQ24(0.25), IQ24(0.25))};
    iqfoc_adapt_block(&adapt, &bounds, &w, &config, any());
    const iqfoc_tuned_law_t law = {any_salient(IQFOC_TUNED_K_LEAST_Q26), 0, 0, 0, 0};
    (void)iqfoc_adapt_law(&law, &adapt);
}

/* Watch of the angle sensor: any configuration that is not refused, any observer and difference, from any state of the header. */
void prove_watch_angle(void)
{
    const iqfoc_watch_angle_config_t config = {any(), any(), any(), any(), any(), any()};
    iqfoc_sensorless_t s;
    iqfoc_watch_angle_t w;
    if (iqfoc_watch_angle_init(&w, &config) == IQFOC_OK) {
        s.observer.theta_q32 = any();
        s.observer.speed_q32 = any_within(-256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        s.observer.locked = any_bool();
        s.on = any_count(0, 3);
        s.difference = any_within(IQ24(-0.5), IQ24(0.5));
        w.count = any_within(0, 32767);
        w.base = any_within(IQ24(-0.5), IQ24(0.5));
        w.theta = any_within(IQ24(-0.5), IQ24(0.5));
        w.turn = any_within(0, 63);
        w.path = any_within(-64 * IQ24_ONE, 64 * IQ24_ONE);
        w.wait = any_within(-63, 4);
        w.first = any_within(IQ24(-0.5), IQ24(0.5));
        w.moved = any_within(0, IQ24(0.5));
        w.blocks = any_count(0, UINT32_MAX);
        w.naming = any_within(0, 4);
        for (int32_t k = 0; k < 3; k++) {
            w.sum[k] = (int64_t)any_within(-IQ24(0.5), IQ24(0.5)) * 32766;
            w.up[k] = any_within(0, IQ24(0.5));
            w.down[k] = any_within(0, IQ24(0.5));
        }
        (void)iqfoc_watch_angle_step(&w, &s);
    }
}

static iqfoc_sample_t any_measured(void)
{
    const iqfoc_sample_t s = {.i = any_abc(IQ24_MIN, IQ24_MAX),
                              .theta = any(),
                              .speed = any(),
                              .u_dc = any(),
                              .clipped = any_bool()};
    return s;
}

/* A commissioning in any state of the header but its phase, with these cycles in its sums. */
static void any_commission(iqfoc_commission_t *c, const iqfoc_commission_config_t *config, int32_t summed)
{
    c->result.i_offset = any_abc(-IQ24_ONE, IQ24_ONE);
    c->result.i_offset_half = any_abc(0, IQ24(0.25));
    c->result.r.value = any_within(0, IQ24_ONE);
    c->result.r.half = any_within(0, IQ24_MAX);
    c->result.v_dead.value = any_within(-IQ24(0.25), IQ24(0.25));
    c->result.v_dead.half = any_within(0, IQ24_MAX);
    c->result.l_d.value = any_within(IQ24(0.0625), IQ24(8.0));
    c->result.l_d.half = any_within(0, IQ24_MAX);
    c->result.l_q.value = any();
    c->result.l_q.half = any_within(0, IQ24_MAX);
    c->offset.offset = c->result.i_offset;
    c->start.config = &config->start;
    c->start.stage = (iqfoc_start_stage_t)any_within(0, 6);
    c->start.done = any_count(0, (1 << 24) - 1);
    c->start.theta = any();
    c->start.speed = any_within(-IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    c->start.i_ref.d = any_within(0, IQ24(2.0));
    c->start.i_ref.q = 0;
    c->cycles = any_count(0, UINT32_MAX - 1);
    c->wait = any_count(0, 1 << 24);
    c->position = any_count(1, 64);
    c->amplitude = any_within(1, IQ24(0.5));
    c->bias = any_within(-IQ24(8.0), IQ24(8.0));
    c->half_u = any_within(0, IQ24(0.5));
    c->half_d = any_within(0, IQ24(16.0));
    c->l_rough = any_within(IQ24(0.0625), IQ24(8.0));
    c->across = any_within(-IQ24(22.0), IQ24(22.0));
    c->u_dq = any_dq(IQ24(8.0));
    c->gains.kp_d = any_within(0, IQ24(2.8));
    c->gains.kp_q = any_within(0, IQ24(2.8));
    c->gains.ki_d = any_within(0, IQ24(0.3));
    c->gains.ki_q = any_within(0, IQ24(0.3));
    c->gains.anti_windup = any_within(0, IQ24(0.35));
    c->control.integral_d = iq24_acc_mul(any_within(-IQ24(8.0), IQ24(7.9)), IQ24_ONE);
    c->control.integral_q = iq24_acc_mul(any_within(-IQ24(8.0), IQ24(7.9)), IQ24_ONE);
    for (int32_t k = 0; k < 4; k++) {
        c->sum[k] = (int64_t)any_within(-IQ24(5.4), IQ24(5.4)) * summed;
    }
    for (int32_t k = 0; k < IQFOC_COMMISSION_BLOCKS; k++) {
        c->x[k] = any_within(-IQ24(8.0), IQ24(8.0));
        c->y[k] = any_within(-IQ24(8.0), IQ24(8.0));
    }
}

static iqfoc_commission_config_t any_commission_config(uint32_t block_log2, uint32_t half_log2)
{
    const iqfoc_commission_config_t config = {
        {any_count(0, UINT32_MAX), any_count(2, 16), any(), any()},
        {any(), any_count(1, 1 << 24), any_count(1, 1 << 24), any(), any_count(1, 1 << 24)},
        any(),
        any(),
        any(),
        any_count(0, UINT32_MAX),
        any_count(0, UINT32_MAX),
        block_log2,
        half_log2,
        any(),
        any(),
        any()};
    return config;
}

/* Self-commissioning with any configuration that is not refused, one step of each phase with current control: any sample. */
void prove_commission(void)
{
    iqfoc_commission_t c;
    const iqfoc_commission_config_t whatever =
        any_commission_config(any_count(0, UINT32_MAX), any_count(0, UINT32_MAX));
    (void)iqfoc_commission_init(&c, &whatever);
    for (uint32_t block_log2 = 6; block_log2 <= 12; block_log2 += 6) {
        const iqfoc_commission_config_t config = any_commission_config(block_log2, 1);
        if (iqfoc_commission_init(&c, &config) == IQFOC_OK) {
            any_commission(&c, &config, (1 << block_log2) - 1);
            c.phase = any_bool()   ? IQFOC_COMMISSION_STAIRCASE
                      : any_bool() ? IQFOC_COMMISSION_SPIN
                      : any_bool() ? IQFOC_COMMISSION_ALIGN
                                   : IQFOC_COMMISSION_RUN_UP;
            c.in_block = any_count(0, (1 << block_log2) - 1);
            c.blocks = any_count(0, IQFOC_COMMISSION_BLOCKS - 1);
            const iqfoc_sample_t sample = any_measured();
            iqfoc_commission_abort(&c);
            c.abort_requested = any_bool();
            (void)iqfoc_commission_step(&c, &sample);
        }
    }
}

/* The same for the first phases; the parameter set. */
void prove_commission_seek(void)
{
    iqfoc_commission_t c;
    iqfoc_flux_predictor_t predictor;
    iqfoc_extension_t extension;
    for (uint32_t half_log2 = 1; half_log2 <= 2; half_log2++) {
        const iqfoc_commission_config_t config = any_commission_config(6, half_log2);
        if (iqfoc_commission_init(&c, &config) == IQFOC_OK) {
            any_commission(&c, &config, 4);
            c.phase = any_bool()   ? IQFOC_COMMISSION_SEEK_ALPHA
                      : any_bool() ? IQFOC_COMMISSION_SEEK_BETA
                                   : IQFOC_COMMISSION_OFFSET;
            const iqfoc_sample_t sample = any_measured();
            (void)iqfoc_commission_step(&c, &sample);
            iqfoc_commission_parameters(&c.result, &predictor, &extension);
        }
    }
}

/* The same for the square wave on a current. */
void prove_commission_wave(void)
{
    iqfoc_commission_t c;
    for (uint32_t half_log2 = 1; half_log2 <= 2; half_log2++) {
        for (uint32_t block_log2 = 6; block_log2 <= 12; block_log2 += 6) {
            const iqfoc_commission_config_t config = any_commission_config(block_log2, half_log2);
            if (iqfoc_commission_init(&c, &config) == IQFOC_OK) {
                any_commission(&c, &config, 1 << block_log2);
                c.phase = any_bool()   ? IQFOC_COMMISSION_INDUCTANCE_D
                          : any_bool() ? IQFOC_COMMISSION_INDUCTANCE_Q
                                       : IQFOC_COMMISSION_SHAFT;
                c.in_block = any_count(0, (1 << block_log2) - 1);
                c.blocks = any_count(0, IQFOC_COMMISSION_BLOCKS);
                const iqfoc_sample_t sample = any_measured();
                (void)iqfoc_commission_step(&c, &sample);
            }
        }
    }
}

/*
 * Digests of the drive services and sensors (golden_vectors.h). Functions with a state keep it from input to input,
 * and are initialised again every thousand inputs.
 */
#include "golden_around.h"

#include "golden_types.h"

#include "iqfoc/encoder.h"
#include "iqfoc/halls.h"
#include "iqfoc/observer.h"
#include "iqfoc/offset.h"
#include "iqfoc/resolver.h"
#include "iqfoc/restart.h"
#include "iqfoc/shunts.h"
#include "iqfoc/speed_control.h"
#include "iqfoc/start.h"
#include "iqfoc/supervision.h"
#include "iqfoc/synchronous_carrier.h"
#include "iqfoc/tracker.h"

#define AGAIN 1000

static uint32_t below(golden_inputs_t *inputs, uint32_t limit)
{
    return (uint32_t)golden_positive(inputs, (iq24_t)limit - 1);
}

static void add_encoder(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_encoder_config_t config = {.index_known = true};
    config.counts_per_turn = 4 + below(inputs, 65533);
    config.pole_pairs = 1 + below(inputs, 64);
    config.index_theta = golden_within(inputs, IQ24_MAX);
    iqfoc_encoder_t encoder;
    digest_add(digest, (int32_t)iqfoc_encoder_init(&encoder, &config));
    for (uint32_t k = 0; k < 3; k++) {
        (void)iqfoc_encoder_index(&encoder, below(inputs, config.counts_per_turn));
        digest_add(digest, iqfoc_encoder_theta(&encoder, below(inputs, config.counts_per_turn)));
        digest_add(digest, iqfoc_encoder_index_theta(&encoder));
        digest_add(digest, encoder.slip);
    }
}

static iqfoc_resolver_angle_t resolver(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_resolver_t r;
    r.offset_sin = golden_within(inputs, IQ24(4.0));
    r.offset_cos = golden_within(inputs, IQ24(4.0));
    r.gain_sin = IQ24(0.0625) + golden_positive(inputs, IQ24(15.9));
    r.gain_cos = IQ24(0.0625) + golden_positive(inputs, IQ24(15.9));
    r.amplitude_max = 2 + golden_positive(inputs, IQ24(2.0) - 2);
    r.amplitude_min = 1 + golden_positive(inputs, r.amplitude_max - 2);
    r.ratio = 1 + (iq24_t)below(inputs, 64);
    r.theta_0 = golden_within(inputs, IQ24_ONE);
    digest_add(digest, (int32_t)iqfoc_resolver_check(&r));
    iq24_t a;
    iq24_t b;
    golden_pair(inputs, &a, &b);
    return iqfoc_resolver_read(&r, a, b);
}

static void add_halls(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_halls_config_t config = IQFOC_HALLS(300);
    static const uint32_t order[6] = {1, 3, 2, 6, 4, 5};
    static iqfoc_halls_t halls;
    static uint32_t place;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_halls_init(&halls, &config);
    }
    /* A second run begins where the first did. */
    place = inputs->number == 1 ? 0 : place;
    /* Mostly on by one or not at all, now and then anything. */
    const uint32_t draw = below(inputs, 64);
    place = draw < 40 ? place : draw < 58 ? (place + 1) % 6 : (place + 5) % 6;
    const uint32_t bits = draw == 63 ? below(inputs, 8) : order[place];
    iqfoc_halls_step(&halls, bits, below(inputs, 300));
    digest_add(digest, halls.theta);
    digest_add(digest, halls.speed);
    digest_add(digest, (int32_t)halls.faults);
}

static void add_tracker(golden_inputs_t *inputs, uint64_t *digest, iqfoc_resolver_angle_t angle)
{
    static const iqfoc_tracker_config_t config = {IQ24(0.3), IQ24(0.05), IQ24(0.004), IQ24(0.4), 5};
    static iqfoc_tracker_t tracker;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_tracker_init(&tracker, &config);
    }
    const iq24_t at = golden_within(inputs, IQ24_ONE);
    iqfoc_tracker_step(&tracker, angle.theta, at, below(inputs, 8) != 0);
    digest_add(digest, tracker.theta_q32);
    digest_add(digest, tracker.speed_q32);
    digest_add(digest, tracker.acceleration_q32);
    digest_add(digest, iqfoc_tracker_theta(&tracker, golden_within(inputs, IQ24(8.0))));
    digest_add(digest, iqfoc_tracker_speed(&tracker));
    digest_add(digest, tracker.lost ? 1 : 0);
}

/* Every other thousand with saturation. */
static void add_observer(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_observer_config_t configs[2] = {
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 5e-3, 0.12, 2e-4, 10.0, 300.0, 800.0, IQ24(0.005)),
        {IQFOC_FLUX_PREDICTOR(0.5, 4e-3, 4e-3, 0.12, 2e-4, 10.0, 300.0), IQ24(0.3), IQ24(0.75), IQ24(0.4),
         IQ24(0.05), IQ24(0.01), IQ24(0.1), IQ24(0.5), 2, 3, 9}};
    static iqfoc_observer_t observer;
    const iqfoc_ab_t i = golden_ab(inputs, IQ24(2.0));
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_observer_init(&observer, &configs[inputs->number / AGAIN % 2]);
        const iq24_t theta = golden_within(inputs, IQ24_MAX);
        iqfoc_observer_start(&observer, i, theta, golden_within(inputs, IQ24(0.33)), true);
    }
    const iqfoc_ab_t u = golden_ab(inputs, IQ24(0.6));
    iqfoc_observer_step(&observer, u, iqfoc_observer_mean(i, u, i), i);
    digest_ab(digest, observer.psi);
    digest_add(digest, observer.theta_q32);
    digest_add(digest, observer.speed_q32);
    digest_add(digest, observer.flux_error);
    digest_add(digest, iqfoc_observer_theta(&observer, golden_within(inputs, IQ24(8.0))));
    digest_add(digest, iqfoc_observer_speed(&observer));
    digest_add(digest, (int32_t)observer.status);
    digest_add(digest, observer.locked ? 1 : 0);
}

/* Around the set-point, so that now the error decides, now the limit. */
static void add_speed_control(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_speed_control_config_t config =
        IQFOC_SPEED_CONTROL(40.0, 2e-3, 3, 0.134, 2e-4, 15.0, 4000.0, 20.0, 2);
    static iqfoc_speed_control_t control;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_speed_control_init(&control, &config);
        const iq24_t speed = golden_within(inputs, IQ24(0.4));
        iqfoc_speed_control_start(&control, speed, golden_within(inputs, IQ24(2.0)));
    }
    const iq24_t near = iq24_asr32(control.set_point_q32, 8);
    const iq24_t target = near + golden_within(inputs, IQ24(0.001));
    const iq24_t speed = near + golden_within(inputs, IQ24(0.02));
    digest_add(digest, iqfoc_speed_control_step(&control, target, speed, golden_positive(inputs, IQ24(2.0))));
    digest_add(digest, control.set_point_q32);
    digest_add(digest, iq24_acc_trunc(control.integral));
    digest_add(digest, iq24_wrap(control.integral));
}

/* A rotor whose angle follows the carrier's periods, at speeds of all levels; and the set of the period. */
static void add_synchronous_carrier(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_synchronous_level_t level[4] = {
        {0, 0, 0}, {21, IQ24(0.05), IQ24(0.045)}, {15, IQ24(0.07), IQ24(0.06)}, {9, IQ24(0.12), IQ24(0.11)}};
    static const iqfoc_synchronous_config_t config = {level, 4,          17000,       8500,
                                                      68000, IQ24(0.75), IQ24(0.125), IQ24(0.3)};
    static iqfoc_synchronous_carrier_t carrier;
    static iq24_t angle;
    static iq24_t nominal;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_synchronous_carrier_init(&carrier, &config);
        nominal = golden_within(inputs, IQ24(0.15));
        angle = 0;
    }
    const iqfoc_cycle_config_t base = {
        .predictor = {golden_positive(inputs, IQ24(15.9)), golden_positive(inputs, IQ24_ONE), 0},
        .gains = {0, 0, golden_positive(inputs, IQ24(32.0)), golden_positive(inputs, IQ24_ONE),
                  golden_positive(inputs, IQ24_ONE), golden_positive(inputs, IQ24(96.0)),
                  golden_positive(inputs, IQ24_ONE), golden_positive(inputs, IQ24(96.0))},
        .period_ticks = 17000,
        .tolerance_ticks = (uint32_t)golden_positive(inputs, 8500),
        .stale_ticks = (uint32_t)golden_positive(inputs, 8500),
        .deadline_ticks = (uint32_t)golden_positive(inputs, IQ24_MAX)};
    nominal = iq24_clamp(nominal + golden_within(inputs, IQ24(0.001)), IQ24(-0.2), IQ24(0.2));
    const iq24_t speed = iq24_mul_sat(nominal, iq24_div((iq24_t)carrier.ticks, 17000));
    angle = iq24_add_wrap(angle, speed + golden_within(inputs, IQ24(0.001)));
    iqfoc_cycle_config_t set;
    iqfoc_synchronous_carrier_set(&base, iqfoc_synchronous_carrier_step(&carrier, angle, speed), &set);
    iqfoc_cycle_t cycle = {.config = &base,
                           .next = &set,
                           .u_dq = golden_dq(inputs, IQ24(2.0)),
                           .i_ref = golden_dq(inputs, IQ24(2.0))};
    cycle.rotor.speed = speed;
    iqfoc_synchronous_carrier_keep_flux(&carrier, &cycle);
    digest_dq(digest, carrier.mean_off_next);
    digest_dq(digest, cycle.u_dq);
    digest_add(digest, iq24_acc_trunc(cycle.control.integral_d));
    digest_add(digest, iq24_acc_trunc(cycle.control.integral_q));
    digest_add(digest, carrier.level);
    digest_add(digest, carrier.error);
    digest_add(digest, (int32_t)set.period_ticks);
    digest_add(digest, set.predictor.k_u);
    digest_add(digest, set.predictor.k_r);
    digest_add(digest, set.gains.ki_d);
    digest_add(digest, set.gains.ki_q);
    digest_add(digest, set.gains.anti_windup);
    digest_add(digest, set.gains.x_d);
    digest_add(digest, set.gains.x_q);
    digest_add(digest, set.gains.emf);
    digest_add(digest, (int32_t)set.tolerance_ticks);
    digest_add(digest, (int32_t)set.stale_ticks);
    digest_add(digest, (int32_t)set.deadline_ticks);
}

/* The resolver draws a pair, which counts the input. */
void golden_angle_sensors(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_resolver_angle_t angle = resolver(inputs, digest);
    digest_add(digest, angle.theta);
    digest_add(digest, angle.valid ? 1 : 0);
    add_encoder(inputs, digest);
    add_halls(inputs, digest);
    add_tracker(inputs, digest, angle);
    add_observer(inputs, digest);
    add_speed_control(inputs, digest);
    add_synchronous_carrier(inputs, digest);
}

static void add_offset(golden_inputs_t *inputs, uint64_t *digest)
{
    iqfoc_offset_limits_t limits = {1, 3, 0, 0};
    limits.offset_max = 1 + golden_positive(inputs, IQ24_ONE - 1);
    limits.noise_max = 1 + golden_positive(inputs, IQ24(0.125) - 1);
    iqfoc_offset_t offset;
    (void)iqfoc_offset_init(&offset, &limits);
    const iqfoc_abc_t place = golden_abc(inputs, IQ24_ONE);
    while (offset.verdict == IQFOC_OFFSET_BUSY) {
        const iqfoc_abc_t noise = golden_abc(inputs, IQ24(0.05));
        const iqfoc_abc_t i = {place.a + noise.a, place.b + noise.b, place.c + noise.c};
        (void)iqfoc_offset_step(&offset, i);
    }
    digest_add(digest, (int32_t)offset.verdict);
    digest_add(digest, (int32_t)offset.faulty);
    digest_abc(digest, offset.offset);
    digest_abc(digest, offset.noise);
    digest_abc(digest, iqfoc_offset_removed(&offset, golden_abc(inputs, IQ24_MAX)));
}

static void add_shunts(golden_inputs_t *inputs, uint64_t *digest)
{
    const iqfoc_shunts_t shunts = {IQ24(0.25) + golden_positive(inputs, IQ24(0.75))};
    digest_add(digest, (int32_t)iqfoc_shunts_check(&shunts));
    iqfoc_abc_t duties;
    duties.a = golden_positive(inputs, IQ24_ONE);
    duties.b = golden_positive(inputs, IQ24_ONE);
    duties.c = golden_positive(inputs, IQ24_ONE);
    const iqfoc_abc_t i = golden_abc(inputs, IQ24(15.9));
    const iqfoc_shunts_currents_t got = iqfoc_shunts_read(&shunts, i, duties, golden_abc(inputs, IQ24_ONE));
    digest_abc(digest, got.i);
    digest_add(digest, (int32_t)got.usable);
    digest_abc(digest, iqfoc_shunts_make_room(&shunts, duties));
}

static void add_start(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_start_config_t config = {IQ24(0.7), 200, 90, IQ24(-0.11), 300};
    static iqfoc_start_t start;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_start_init(&start, &config);
    }
    iqfoc_start_step(&start, golden_within(inputs, IQ24_MAX));
    digest_dq(digest, start.i_ref);
    digest_add(digest, (int32_t)start.verdict);
    digest_add(digest, iqfoc_start_theta(&start, golden_within(inputs, IQ24_ONE)));
    digest_dq(digest, iqfoc_start_handover(&start, golden_within(inputs, IQ24_MAX)));
}

static void add_watch(golden_inputs_t *inputs, uint64_t *digest)
{
    static const iqfoc_supervision_config_t watched = {IQ24(0.1), IQ24(0.125), 12, 2, IQ24(0.2), 3};
    static const iqfoc_restart_config_t restarts = {6, 5, 3, 20};
    static iqfoc_supervision_t supervision;
    static iqfoc_restart_t restart;
    if (inputs->number % AGAIN == 1) {
        (void)iqfoc_supervision_init(&supervision, &watched);
        (void)iqfoc_restart_init(&restart, &restarts);
    }
    iqfoc_abc_t i = golden_abc(inputs, IQ24(2.0));
    i.a = inputs->number % AGAIN > 500 ? 0 : i.a;
    i.c = -(i.a + i.b) + (below(inputs, 16) == 0 ? IQ24(0.3) : 0);
    digest_add(digest,
               (int32_t)iqfoc_supervision_step(&supervision, i, golden_within(inputs, IQ24(0.33)), true));
    digest_add(digest, (int32_t)supervision.phase);
    digest_add(digest, (int32_t)iqfoc_restart_step(&restart, below(inputs, 8) == 0 ? below(inputs, 16) : 0));
    if (below(inputs, 256) == 0) {
        iqfoc_restart_acknowledge(&restart);
        iqfoc_supervision_clear(&supervision);
    }
}

void golden_start_and_watch(golden_inputs_t *inputs, uint64_t *digest)
{
    inputs->number++;
    add_offset(inputs, digest);
    add_shunts(inputs, digest);
    add_start(inputs, digest);
    add_watch(inputs, digest);
}
